#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
void import_cameras(Document& document, Scene& scene);
// KHR_lights_punctual. A light whose numbers have no meaning is refused, with its name.
void import_lights(Document& document, Scene& scene);
// Warns of animation keys that give a light a value without meaning; when such a frame comes, the value is clamped,
// with a warning again (animation_targets.h).
void check_animated_lights(Document& document, const Scene& scene);
}  // namespace candela::gltf
