#pragma once
#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace candela {

// Neighbours among the instances of a node: a box about all that they show, in the node's space, metres.
struct InstanceCluster {
  DAabb box;
  // No less than what is added up on the way to any of their vertices, by axis: what floats round is a fraction of it.
  glm::dvec3 magnitude{0};
  uint32_t first = 0, count = 0;  // of InstanceSet::order
};

// The instances of one node (EXT_mesh_gpu_instancing).
struct InstanceSet {
  uint32_t node = 0;
  uint32_t first = 0;  // among all instances of all sets
  uint32_t count = 0;
  bool mirrored = false;           // all of them turn surfaces inside out; else none does
  InstanceCluster all;             // about all clusters
  std::vector<uint32_t> sections;  // of the mesh that can be drawn
  std::vector<InstanceCluster> clusters;
  std::vector<uint32_t> order;  // of the instances by clusters
  std::vector<glm::dmat4> node_from_instance;
};

// The instances that a compute pass can pose (passes/geometry/pose_items.h), one after the other in the order of nodes:
// all sets but those that are skinned or morphed, lie beyond 1e15 m, are flat, or are mirrored in part.
struct InstanceLayout {
  std::vector<InstanceSet> sets;
  std::vector<int> set_of_node;  // -1: none
  uint32_t instance_count = 0;
};
InstanceLayout layout_instances(const Scene& scene);

// Whether the sign of the matrix's determinant is beyond doubt, also of its product with another such one.
bool turns_surely(const glm::dmat4& m);

}  // namespace candela
