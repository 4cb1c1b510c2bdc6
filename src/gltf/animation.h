#pragma once
#include <set>

#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
// The JSON pointers that KHR_animation_pointer channels of the file drive.
std::set<std::string> animated_pointers(const Document& document);
// Fills scene.animations; everything that is driven must be there already.
// needed: they are going to play. Else those that cannot be read are empty, with a warning.
void import_animations(Document& document, bool needed, Scene& scene);
}  // namespace candela::gltf
