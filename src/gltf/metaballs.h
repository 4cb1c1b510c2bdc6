#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
// CANDELA_metaballs: fills scene.metaballs, and gives each node that has them a mesh of its own. Nodes and materials
// must be there already.
void import_metaballs(Document& document, Scene& scene);
}  // namespace candela::gltf
