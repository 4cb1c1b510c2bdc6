#include "bvh/wide_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "bvh/simd.h"

namespace candela {
namespace {

constexpr uint32_t top_levels = 3;  // made before the rest is shared among threads

// Collapses a subtree; indices count from its own nodes and leaves.
class Collapse {
 public:
  Collapse(const BinaryTree& tree, std::span<const TriangleCorners> triangles, WideTree& out)
      : tree_(tree), triangles_(triangles), out_(out) {}

  struct Work {
    uint32_t binary, wide, depth;
  };

  // From a binary node down to `levels` wide ones; returns what is left to do, whose wide index has no node yet.
  std::vector<Work> run(uint32_t binary, uint32_t levels) {
    std::vector<Work> left;
    std::vector<Work> stack{{binary, 0, 1}};
    out_.nodes.emplace_back();
    while (!stack.empty()) {
      const Work work = stack.back();
      stack.pop_back();
      fill(work, work.depth < levels ? stack : left, work.depth < levels);
    }
    return left;
  }

 private:
  void fill(const Work& work, std::vector<Work>& next, bool make_nodes) {
    out_.depth = std::max(out_.depth, work.depth);
    uint32_t child[wide_children];
    const uint32_t count = open(work.binary, child);
    WideNode node{};
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (uint32_t c = 0; c < wide_children; ++c) {
      for (int a = 0; a < 3; ++a) {
        node.bounds[2 * a][c] = c < count ? tree_.nodes[child[c]].low[a] : infinity;
        node.bounds[2 * a + 1][c] = c < count ? tree_.nodes[child[c]].high[a] : -infinity;
      }
      node.child[c] = no_child;
      if (c >= count) continue;
      if (gather(child[c])) {
        node.child[c] = leaf();
      } else if (make_nodes) {
        node.child[c] = uint32_t(out_.nodes.size());
        next.push_back({child[c], node.child[c], work.depth + 1});
        out_.nodes.emplace_back();
      } else {
        next.push_back({child[c], work.wide * wide_children + c, work.depth + 1});  // where its index belongs
      }
    }
    out_.nodes[work.wide] = node;
  }

  // Opens the inner child of largest area until there are eight; ties: the first.
  uint32_t open(uint32_t binary, uint32_t (&child)[wide_children]) const {
    if (!tree_.nodes[binary].inner) {  // a tree of one leaf
      child[0] = binary;
      return 1;
    }
    float area[wide_children];
    uint32_t count = 0;
    const auto put = [&](uint32_t at, uint32_t node) {
      child[at] = node;
      area[at] = tree_.nodes[node].inner ? tree_.nodes[node].half_area() : -1.0f;
    };
    put(count++, tree_.nodes[binary].first), put(count++, tree_.nodes[binary].first + 1);
    while (count < wide_children) {
      const uint32_t widest = uint32_t(std::max_element(area, area + count) - area);
      if (area[widest] < 0) break;
      const uint32_t first = tree_.nodes[child[widest]].first;
      put(widest, first), put(count++, first + 1);
    }
    // By area, the largest last: searches for any hit go there first (Nah and Manocha, "SATO: Surface Area Traversal
    // Order for Shadow Ray Tracing", 2014).
    for (uint32_t c = 0; c < count; ++c) area[c] = tree_.nodes[child[c]].half_area();
    for (uint32_t c = 1; c < count; ++c)
      for (uint32_t at = c; at > 0 && area[at] < area[at - 1]; --at)
        std::swap(area[at], area[at - 1]), std::swap(child[at], child[at - 1]);
    return count;
  }

  // The references below a leaf, or below an inner node if they fit into one block, which costs a ray less than a node
  // whose leaves each have a block. False: too many.
  bool gather(uint32_t binary) {
    ids_.clear();
    if (tree_.nodes[binary].inner && triangles_.empty()) return false;
    uint32_t stack[2 * block_triangles], waiting = 0;
    stack[waiting++] = binary;
    while (waiting > 0) {
      const BinaryNode& node = tree_.nodes[stack[--waiting]];
      if (node.inner) {
        // Every node left to see has a reference at least.
        if (ids_.size() + waiting + 2 > block_triangles) return false;
        stack[waiting++] = node.first + 1, stack[waiting++] = node.first;
        continue;
      }
      for (uint32_t i = node.first; i < node.first + node.count; ++i) {
        const uint32_t id = tree_.references[i].id;
        if (std::find(ids_.begin(), ids_.end(), id) == ids_.end()) ids_.push_back(id);  // parts of one triangle
      }
      if (&node != &tree_.nodes[binary] && ids_.size() + waiting > block_triangles) return false;
    }
    return true;
  }

  uint32_t leaf() {
    const uint32_t count = uint32_t(ids_.size());
    out_.references += count;
    if (triangles_.empty()) {
      const uint32_t first = uint32_t(out_.indices.size());
      out_.indices.insert(out_.indices.end(), ids_.begin(), ids_.end());
      CHECK(count <= largest_leaf && out_.indices.size() <= leaf_first_mask);
      return leaf_child(first, count);
    }
    const uint32_t first = uint32_t(out_.blocks.size()), blocks = (count + block_triangles - 1) / block_triangles;
    CHECK(blocks <= largest_leaf && first + blocks <= leaf_first_mask);
    for (uint32_t b = 0; b < blocks; ++b) {
      TriangleBlock& block = out_.blocks.emplace_back();
      const TriangleCorners* lanes[block_triangles];
      for (uint32_t lane = 0; lane < block_triangles; ++lane) {
        const uint32_t i = b * block_triangles + lane;
        block.id[lane] = i < count ? ids_[i] : no_triangle;
        lanes[lane] = &triangles_[ids_[std::min(i, count - 1)]];
      }
      for (int corner = 0; corner < 3; ++corner) {
        F4 of[block_triangles];
        for (uint32_t lane = 0; lane < block_triangles; ++lane) of[lane] = F4::load3(&lanes[lane]->corner[corner].x);
        transpose(of[0], of[1], of[2], of[3]);
        for (int axis = 0; axis < 3; ++axis) of[axis].store(block.corner[corner][axis]);
      }
    }
    return leaf_child(first, blocks);
  }

  const BinaryTree& tree_;
  std::span<const TriangleCorners> triangles_;
  WideTree& out_;
  std::vector<uint32_t> ids_;  // of the leaf at hand
};

struct Part {
  WideTree tree;
  uint32_t node = 0, block = 0, index = 0;  // where its own begin in the whole
};

void append(WideTree& out, const Part& part) {
  for (size_t n = 0; n < part.tree.nodes.size(); ++n) {
    WideNode node = part.tree.nodes[n];
    for (uint32_t& child : node.child) {
      if (child == no_child) continue;
      if (!(child & leaf_bit))
        child += part.node;
      else
        child += part.tree.blocks.empty() ? part.index : part.block;
    }
    out.nodes[part.node + n] = node;
  }
  std::copy(part.tree.blocks.begin(), part.tree.blocks.end(), out.blocks.begin() + part.block);
  std::copy(part.tree.indices.begin(), part.tree.indices.end(), out.indices.begin() + part.index);
}

}  // namespace

WideTree collapse(const BinaryTree& tree, std::span<const TriangleCorners> triangles) {
  WideTree out;
  if (tree.empty()) return out;
  out.bounds = tree.nodes[0].box();
  const std::vector<Collapse::Work> left = Collapse(tree, triangles, out).run(0, top_levels);
  std::vector<Part> parts(left.size());
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t i) {
    Collapse(tree, triangles, parts[i].tree).run(left[i].binary, std::numeric_limits<uint32_t>::max());
  });
  size_t nodes = out.nodes.size(), blocks = out.blocks.size(), indices = out.indices.size();
  for (size_t i = 0; i < parts.size(); ++i) {
    const WideTree& part = parts[i].tree;
    parts[i].node = uint32_t(nodes), parts[i].block = uint32_t(blocks), parts[i].index = uint32_t(indices);
    nodes += part.nodes.size(), blocks += part.blocks.size(), indices += part.indices.size();
    out.nodes[left[i].wide / wide_children].child[left[i].wide % wide_children] = parts[i].node;
    out.depth = std::max(out.depth, top_levels + part.depth);
    out.references += part.references;
  }
  CHECK_MSG(nodes < leaf_bit && blocks <= leaf_first_mask && indices <= leaf_first_mask,
            "more triangles than a tree's 32-bit references reach");
  out.nodes.resize(nodes), out.blocks.resize(blocks), out.indices.resize(indices);
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t i) { append(out, parts[i]); });
  return out;
}

Hash128 hash_of(const WideTree& tree) {
  const Hash128 nodes = hash128(std::as_bytes(std::span(tree.nodes)));
  const Hash128 blocks = hash128(std::as_bytes(std::span(tree.blocks)), nodes.lo);
  return hash128(std::as_bytes(std::span(tree.indices)), blocks.lo ^ nodes.hi);
}

}  // namespace candela
