#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
// Fills scene.meshes from the document. Materials must be there already: a normal texture asks for tangents.
void import_meshes(Document& document, Scene& scene);
}  // namespace candela::gltf
