#pragma once
#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace candela::gltf {
void import_cameras(Document& document, Scene& scene);
// KHR_lights_punctual. A light whose numbers have no meaning is refused, with its name.
void import_lights(Document& document, Scene& scene);
}  // namespace candela::gltf
