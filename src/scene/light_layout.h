#pragma once
#include <cstdint>
#include <vector>

#include "scene/light_instances.h"
#include "scene/scene.h"

namespace candela {

// Neighbours among the instances of a node: a ball about their places, in the node's space, metres.
struct LightCluster {
  glm::vec3 centre{0};
  float radius_m = 0;
  float range_m = 0;              // the largest of their own; 0 without
  uint32_t first = 0, count = 0;  // of LightSet::places
};

// The light instances of one node, where each of them shines at any time.
struct LightSet {
  uint32_t node = 0;
  uint32_t first = 0;  // among all instances of all sets
  uint32_t count = 0;
  float farthest_m = 0;  // from the node's origin
  // What the template's intensity is multiplied by, by the largest channel: of the darkest instance at its darkest
  // moment, and of the brightest.
  double darkest = 1, brightest = 1;
  std::vector<LightCluster> clusters;
  std::vector<glm::vec4> places;  // of the instances by clusters, in the node's space, and their own ranges, or 0
};

// The light instances that a compute pass can pose (passes/lights/pose_lights.h), one after the other in the order of
// nodes: all sets but those with an instance that is dark at some time, which then is no light of the frame.
struct LightLayout {
  std::vector<LightSet> sets;
  std::vector<int> set_of_node;  // -1: none
  uint32_t instance_count = 0;
};
LightLayout layout_lights(const Scene& scene);

}  // namespace candela
