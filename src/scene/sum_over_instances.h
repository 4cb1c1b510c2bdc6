#pragma once
#include <cstdint>

#include "scene/scene.h"

namespace candela {

// The sum of `count(section)` over the sections that the nodes of a scene show, for each of their instances
// (EXT_mesh_gpu_instancing), whatever is visible at a time.
template <typename Count>
uint64_t sum_over_instances(const Scene& scene, Count count) {
  uint64_t sum = 0;
  for (const int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    if (node.mesh < 0) continue;
    const uint64_t times = node.instances ? node.instances->count : 1;
    for (const MeshSection& section : scene.meshes[size_t(node.mesh)].sections) sum += times * count(section);
  }
  return sum;
}

}  // namespace candela
