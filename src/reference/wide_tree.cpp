#include "reference/wide_tree.h"

#include <algorithm>
#include <limits>

#include "base/check.h"

namespace candela {
namespace {

class Collapse {
 public:
  Collapse(const BinaryTree& tree, std::span<const TriangleCorners> triangles, WideTree& out)
      : tree_(tree), triangles_(triangles), out_(out) {}

  void run() {
    out_.nodes.emplace_back();
    std::vector<Work> stack{{0, 0, 1}};
    while (!stack.empty()) {
      const Work work = stack.back();
      stack.pop_back();
      fill(work, stack);
    }
  }

 private:
  struct Work {
    uint32_t binary, wide, depth;
  };

  void fill(const Work& work, std::vector<Work>& stack) {
    out_.depth = std::max(out_.depth, work.depth);
    uint32_t child[wide_children];
    const uint32_t count = open(work.binary, child);
    WideNode node;
    for (uint32_t c = 0; c < wide_children; ++c) {
      const Aabb box = c < count ? tree_.nodes[child[c]].box : Aabb{};
      for (int a = 0; a < 3; ++a) node.bounds[2 * a][c] = box.min[a], node.bounds[2 * a + 1][c] = box.max[a];
      node.child[c] = no_child;
      if (c >= count) continue;
      const BinaryNode& binary = tree_.nodes[child[c]];
      if (binary.count > 0) {
        node.child[c] = leaf(binary);
      } else {
        node.child[c] = uint32_t(out_.nodes.size());
        stack.push_back({child[c], node.child[c], work.depth + 1});
        out_.nodes.emplace_back();
      }
    }
    out_.nodes[work.wide] = node;
  }

  // Opens the inner child of largest area until there are eight; ties: the first.
  uint32_t open(uint32_t binary, uint32_t (&child)[wide_children]) const {
    if (tree_.nodes[binary].count > 0) {  // a tree of one leaf
      child[0] = binary;
      return 1;
    }
    double area[wide_children];
    uint32_t count = 0;
    const auto put = [&](uint32_t at, uint32_t node) {
      child[at] = node;
      area[at] = tree_.nodes[node].count > 0 ? -1 : half_area(tree_.nodes[node].box);
    };
    put(count++, tree_.nodes[binary].first), put(count++, tree_.nodes[binary].first + 1);
    while (count < wide_children) {
      const uint32_t widest = uint32_t(std::max_element(area, area + count) - area);
      if (area[widest] < 0) break;
      const uint32_t first = tree_.nodes[child[widest]].first;
      put(widest, first), put(count++, first + 1);
    }
    return count;
  }

  uint32_t leaf(const BinaryNode& node) {
    if (triangles_.empty()) {
      const uint32_t first = uint32_t(out_.indices.size());
      for (uint32_t i = 0; i < node.count; ++i) out_.indices.push_back(tree_.references[node.first + i].id);
      CHECK(node.count <= largest_leaf && out_.indices.size() <= leaf_first_mask);
      return leaf_child(first, node.count);
    }
    const uint32_t first = uint32_t(out_.blocks.size()), blocks = (node.count + block_triangles - 1) / block_triangles;
    CHECK(blocks <= largest_leaf && first + blocks <= leaf_first_mask);
    for (uint32_t b = 0; b < blocks; ++b) {
      TriangleBlock& block = out_.blocks.emplace_back();
      for (uint32_t lane = 0; lane < block_triangles; ++lane) {
        const uint32_t i = b * block_triangles + lane;
        block.id[lane] = i < node.count ? tree_.references[node.first + i].id : no_triangle;
        const TriangleCorners& t = triangles_[tree_.references[node.first + std::min(i, node.count - 1)].id];
        for (int corner = 0; corner < 3; ++corner)
          for (int axis = 0; axis < 3; ++axis) block.corner[corner][axis][lane] = t.corner[corner][axis];
      }
    }
    return leaf_child(first, blocks);
  }

  const BinaryTree& tree_;
  std::span<const TriangleCorners> triangles_;
  WideTree& out_;
};

}  // namespace

WideTree collapse(const BinaryTree& tree, std::span<const TriangleCorners> triangles) {
  WideTree out;
  if (tree.empty()) return out;
  out.bounds = tree.nodes[0].box;
  Collapse(tree, triangles, out).run();
  return out;
}

Hash128 hash_of(const WideTree& tree) {
  const Hash128 nodes = hash128(std::as_bytes(std::span(tree.nodes)));
  const Hash128 blocks = hash128(std::as_bytes(std::span(tree.blocks)), nodes.lo);
  return hash128(std::as_bytes(std::span(tree.indices)), blocks.lo ^ nodes.hi);
}

}  // namespace candela
