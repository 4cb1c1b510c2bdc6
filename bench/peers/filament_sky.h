#pragma once
#include <filament/Engine.h>
#include <filament/Scene.h>

#include <string>

#include "base/error.h"

namespace candela::peers {

// An equirectangular image as candela reads it, as Filament's background and image-based light: a cube of 256 texels,
// prefiltered by Filament, and nine harmonics. Its axes and radiances are the image's.
Expected<void> add_sky(filament::Engine& engine, filament::Scene& scene, const std::string& file);

}  // namespace candela::peers
