#pragma once
#include <filesystem>

#include "image/image.h"
#include "stability/stability.h"

namespace candela {

// A scene's files where the run looks for them: scene.glb, plain.glb, sky.exr, plain-sky.exr, second.exr, look.json,
// and its texts.
// Makes the folder. Errors (output): a file could not be written.
Expected<void> write_scene_files(const StabilityScene& scene, const std::filesystem::path& folder);

// The upper bytes of what has 16 bits a channel.
DisplayImage eight_bits(const DisplayImage& image);

}  // namespace candela
