#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
// KHR_materials_variants: reads the names into scene.variants and finds the wanted one; "" is none of them. A name that
// the file does not have is refused with those that it has.
void choose_variant(const Document& document, const std::string& wanted, Scene& scene);

// The material of a primitive in the chosen variant; `otherwise` where it names none.
int material_in_variant(const Document& document, const Json& primitive, const std::string& path, const Scene& scene,
                        int otherwise);
}  // namespace candela::gltf
