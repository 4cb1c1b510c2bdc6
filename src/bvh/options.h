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
  uint32_t block_shift = 2;   // a leaf's triangles are tested by blocks of 1 << block_shift at once
  float node_cost = 0.5f;     // of a step down, in tests of a block
};

}  // namespace candela
