#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/hash.h"
#include "bvh/build.h"
#include "bvh/wide_node.h"
#include "math/bounds.h"

namespace candela {

// The tree that rays traverse: eight children a node, made from a binary one by opening the child of largest area until
// eight are there. Leaves hold blocks of four triangles, or for a tree over other things (instances) their indices.
struct WideTree {
  LargeVector<WideNode> nodes;        // depth first; nodes[0] is the root; empty: nothing to hit
  LargeVector<TriangleBlock> blocks;  // trees over triangles
  std::vector<uint32_t> indices;      // other trees: what leaf offsets count in
  Aabb bounds;
  uint32_t depth = 0;
  size_t references = 0;  // triangles in leaves, those in several counted for each
};

// triangles: three corners each, what the binary tree's ids count in; empty: a tree over other things.
WideTree collapse(const BinaryTree& tree, std::span<const TriangleCorners> triangles);

Hash128 hash_of(const WideTree& tree);

}  // namespace candela
