#pragma once
#include <set>

#include "gltf/document.h"
#include "gltf/gltf.h"

namespace candela::gltf {
// Fills scene.samplers, materials and images; only images that a material uses are read. `pointers`: every JSON pointer
// that an animation drives, because textures whose transforms are animated apart cannot be merged.
void import_materials(Document& document, const std::set<std::string>& pointers, LoadFor use, Scene& scene);
}  // namespace candela::gltf
