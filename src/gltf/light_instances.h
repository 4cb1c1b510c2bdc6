#pragma once
#include <memory>

#include "gltf/document.h"
#include "scene/light_instances.h"
#include "scene/scene.h"

namespace candela::gltf {
// CANDELA_light_instances of a node, or null. Every value is looked at: a light that means nothing is refused by its
// number, the template's name and the attribute's path.
std::shared_ptr<const LightInstances> read_light_instances(Document& document, const Scene& scene, const Json& node,
                                                           const std::string& node_path);
}  // namespace candela::gltf
