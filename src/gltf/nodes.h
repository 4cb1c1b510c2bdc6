#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
// Fills scene.nodes, roots and order. Meshes, cameras and lights must be there already.
void import_nodes(Document& document, Scene& scene);
// Fills scene.skins, and adds joints that lie outside the drawn scene to scene.order, because meshes inside it follow
// them.
void import_skins(Document& document, Scene& scene);
}  // namespace candela::gltf
