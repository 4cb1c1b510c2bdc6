#pragma once
#include <cstdint>

namespace candela {

enum class BvhBuilder : uint8_t {
  equal_counts,  // halves by centroid along the longest axis
  sah,           // binned surface area heuristic (Wald, "On fast Construction of SAH-based BVHs", 2007)
  sbvh,  // and spatial splits (Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009)
  spatial_only,  // spatial splits wherever there is one, whatever it costs: shows that they are made right
};

constexpr bool splits_space(BvhBuilder b) { return b == BvhBuilder::sbvh || b == BvhBuilder::spatial_only; }

constexpr int least_buckets = 2, most_buckets = 64;
constexpr uint32_t most_in_leaf = 128, most_depth = 60;

struct BvhOptions {
  BvhBuilder builder = BvhBuilder::sah;
  int buckets = 32;  // per axis, least_buckets to most_buckets
  float overlap_alpha =
      1e-5f;  // sbvh: spatial splits are tried where children's overlap exceeds this fraction of the root's area
  float split_budget = 1.0f;    // sbvh: references that spatial splits may add, as a fraction of the triangles
  uint32_t max_leaf = 8;        // references in a leaf, 1 to most_in_leaf
  uint32_t depth = most_depth;  // below so many steps down nodes are halved by count, 0 to most_depth
  uint32_t block_shift = 2;     // a leaf's triangles are tested by blocks of 1 << block_shift at once
  float node_cost = 0.5f;       // of a step down, in tests of a block
};

}  // namespace candela
