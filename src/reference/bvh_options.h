#pragma once
#include <cstdint>

namespace candela {

enum class BvhBuilder : uint8_t {
  equal_counts,  // halves by centroid along the longest axis
  sah,           // binned surface area heuristic (Wald, "On fast Construction of SAH-based BVHs", 2007)
  sbvh,  // and spatial splits (Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009)
};

struct BvhOptions {
  BvhBuilder builder = BvhBuilder::sah;
  int buckets = 12;  // per axis, 2 to 64
  float overlap_alpha =
      1e-5f;  // sbvh: spatial splits are tried where children's overlap exceeds this share of the root's area
  float split_budget = 1.0f;  // sbvh: references that spatial splits may add, as a share of the triangles
  uint32_t max_leaf = 8;      // references in a leaf, at most 32 * 4
  float node_cost = 1.0f;     // of a step down, in triangle tests
};

}  // namespace candela
