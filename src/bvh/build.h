#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "bvh/options.h"
#include "bvh/raw_vector.h"
#include "math/bounds.h"

namespace candela {

struct TriangleCorners {
  glm::vec3 corner[3];
};

// A box to build over, with the triangle or instance it belongs to. Spatial splits make several of one triangle, each
// around a part of it ("references" of Popov et al., "Object Partitioning Considered Harmful", 2009).
struct alignas(16) BoxReference {
  float low[3];
  uint32_t id;
  float high[3];
  uint32_t unused;  // 0
};

// The sheared corners of the triangle test are rounded by a fraction of the triangle's size, so it may meet rays that
// pass beside the triangle by that. Boxes are wider by a little more, or traversal would miss what the test would find.
constexpr float rounding_fraction = 0x1p-21f;
BoxReference reference_to(const TriangleCorners& triangle, uint32_t id);

struct BinaryNode {
  float low[3], high[3];
  uint32_t first;  // leaf: into BinaryTree::references; inner: its children are nodes first and first + 1
  uint32_t inner : 1;
  uint32_t count : 31;  // references; below an inner node spatial splits may have added some
  Aabb box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
  float half_area() const {  // half the surface
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return (x * y + y * z) + z * x;
  }
};

// Nodes lie where the references of their subtree lie, with gaps, so that tasks need no common counter; the root is
// node 0.
struct BinaryTree {
  LargeVector<BinaryNode> nodes;
  LargeVector<BoxReference> references;  // leaves' ranges, with gaps where slack was left over
  size_t reference_count = 0;            // in leaves
  size_t node_count = 0;
  uint32_t depth = 0;  // nodes on the longest way down
  bool empty() const { return reference_count == 0; }
};

// Builds over boxes. triangles: what the ids count in, for spatial splits; empty: object splits only. Parallel by
// oneTBB; the tree depends on the input alone, not on the number of threads.
BinaryTree build_tree(std::span<const BoxReference> boxes, std::span<const TriangleCorners> triangles,
                      const BvhOptions& options);

// Expected cost of a ray that meets the root's box, in tests of a block (MacDonald and Booth, "Heuristics for Ray
// Tracing using Space Subdivision", 1990): an inner node costs options.node_cost, a leaf its blocks.
double sah_cost(const BinaryTree& tree, const BvhOptions& options);

}  // namespace candela
