#include "bvh/build.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "bvh/object_split.h"
#include "bvh/spatial_split.h"

namespace candela {
namespace {

// Spatial splits cut every triangle at each plane between its ends, so they try fewer than splits of objects.
constexpr int most_spatial_buckets = 12;
constexpr uint32_t task_size = 2048;  // subtrees above this many references become tasks

// A subtree to build. Its references lie at [begin, begin + count) within its slots [first, last), at the low end or at
// the high end of them; what is left of the slots is the slack that spatial splits may fill.
struct Subtree {
  uint32_t node, first, last, begin, count, depth;
  BuildBox box, centres2;
  void measure(const BoxReference* references) {
    for (uint32_t i = begin; i < begin + count; ++i) {
      const F4 low = low_of(references[i]), high = high_of(references[i]), centre2 = low + high;
      box.add(low, high);
      centres2.add(centre2, centre2);
    }
  }
};

class Builder {
 public:
  Builder(BinaryTree& tree, std::span<const TriangleCorners> triangles, const BvhOptions& options)
      : tree_(tree), triangles_(triangles), options_(options), references_(tree.references.data()) {}

  void build(const Subtree& root) {
    root_area_ = root.box.half_area();
    build_subtree(root);
    group_.wait();
    tree_.depth = depth_.load();
    tree_.reference_count = leaf_references_.load();
    tree_.node_count = 2 * leaves_.load() - 1;
  }

 private:
  void build_subtree(const Subtree& top) {
    Subtree stack[128];  // one waiting sibling a level
    int waiting = 0;
    stack[waiting++] = top;
    uint32_t deepest = 0;
    size_t in_leaves = 0, leaves = 0;
    while (waiting > 0) {
      const Subtree at = stack[--waiting];
      deepest = std::max(deepest, at.depth + 1);
      BinaryNode& node = tree_.nodes[at.node];
      at.box.write(node);
      node.count = at.count & 0x7fffffffu;
      Subtree left, right;
      node.inner = split(at, left, right);
      if (!node.inner) {
        node.first = at.begin;
        in_leaves += at.count, ++leaves;
        continue;
      }
      node.first = left.node;
      if (right.count > task_size)
        group_.run([this, right] { build_subtree(right); });
      else
        stack[waiting++] = right;
      stack[waiting++] = left;
    }
    uint32_t seen = depth_.load();
    while (seen < deepest && !depth_.compare_exchange_weak(seen, deepest)) {
    }
    leaf_references_ += in_leaves, leaves_ += leaves;
  }

  // False: a leaf.
  bool split(const Subtree& at, Subtree& left, Subtree& right) {
    if (at.count == 1) return false;
    // Beyond this depth nodes are halved by count, so no tree is deeper than most_depth plus 32 (and traversal stacks
    // suffice).
    if (at.depth >= options_.depth) return halve(at, left, right);
    if (options_.builder == BvhBuilder::equal_counts) {
      if (at.count <= std::min(options_.max_leaf, 4u)) return false;
      sort_halves(at);
      return halve(at, left, right);
    }
    return split_by_area(at, left, right);
  }

  bool split_by_area(const Subtree& at, Subtree& left, Subtree& right) {
    // One test takes a block, and below one the wide tree has no nodes.
    if (at.count <= std::min(options_.max_leaf, 1u << options_.block_shift)) return false;
    const bool may_cut = splits_space(options_.builder) && !triangles_.empty();
    // Few references do not fill many buckets.
    const Buckets buckets(at.centres2, int(std::min(uint32_t(options_.buckets), 4 + at.count / 4)));
    const Span references{references_ + at.begin, at.count};
    const ObjectSplit object = find_object_split(references, buckets, options_.block_shift, may_cut);
    const uint32_t slack = at.last - at.first - at.count;
    const float area = at.box.half_area();
    SpatialSplit spatial;
    // Where the sides hardly overlap a spatial split has nothing to gain. The share is of the root's area: small nodes
    // deep down do not matter however much they overlap.
    const bool always = options_.builder == BvhBuilder::spatial_only;
    if (may_cut && slack > 0 && (always || object.axis < 0 || object.overlap > options_.overlap_alpha * root_area_))
      spatial = find_spatial_split(references, triangles_, at.box, std::min(options_.buckets, most_spatial_buckets),
                                   options_.block_shift, slack);
    const float best = std::min(object.cost, spatial.cost);
    if (at.count <= options_.max_leaf &&
        !(options_.node_cost * area + best < area * tests_of(at.count, options_.block_shift)))
      return false;
    if ((always ? spatial.axis >= 0 : spatial.cost < object.cost) && cut_in_two(at, spatial, left, right)) return true;
    if (object.axis < 0) return halve(at, left, right);
    partition(at, buckets, object, left, right);
    return true;
  }

  void partition(const Subtree& at, const Buckets& buckets, const ObjectSplit& split, Subtree& left, Subtree& right) {
    // Without branches, which could not be predicted: each reference changes places with the first one of the right
    // side, which begins behind it or does not, and grows both sides' boxes, one of them by numbers that are none.
    const F4 none = F4::all(std::bit_cast<float>(~0u)), some = F4::all(0);
    const F4 to_left[2] = {none, some}, to_right[2] = {some, none};
    BoxReference* const references = references_ + at.begin;
    BuildBox boxes[2], centres2[2];
    uint32_t count = 0;
    for (uint32_t i = 0; i < at.count; ++i) {
      const BoxReference reference = references[i];
      const F4 low = low_of(reference), high = high_of(reference), centre2 = low + high;
      int32_t k[4];
      buckets.of(centre2, k);
      const bool is_left = k[split.axis] < split.bucket;
      const F4 masks[2] = {to_left[is_left], to_right[is_left]};
      for (int side = 0; side < 2; ++side) {
        boxes[side].grow(low | masks[side], high | masks[side]);
        centres2[side].grow(centre2 | masks[side], centre2 | masks[side]);
      }
      references[i] = references[count], references[count] = reference;
      count += is_left;
    }
    left.box = boxes[0], right.box = boxes[1], left.centres2 = centres2[0], right.centres2 = centres2[1];
    CHECK(count > 0 && count < at.count);
    place(at, count, at.count - count, left, right);
  }

  bool cut_in_two(const Subtree& at, const SpatialSplit& spatial, Subtree& left, Subtree& right) {
    BoxReference* low = references_ + at.first;
    if (at.begin != at.first) std::memmove(low, references_ + at.begin, at.count * sizeof(BoxReference));
    Subtree moved = at;
    moved.begin = at.first;
    const SplitCounts sides = apply_spatial_split(low, at.count, at.last - at.first - at.count, triangles_, spatial);
    if (sides.left == 0 || sides.right == 0) {
      // Nothing was cut. Back to where the caller has them.
      if (at.begin != at.first) std::memmove(references_ + at.begin, low, at.count * sizeof(BoxReference));
      return false;
    }
    place(moved, sides.left, sides.right, left, right);
    measure_both(left, right);
    return true;
  }

  // By count, in the order at hand.
  bool halve(const Subtree& at, Subtree& left, Subtree& right) {
    if (at.count <= options_.max_leaf) return false;
    place(at, at.count / 2, at.count - at.count / 2, left, right);
    measure_both(left, right);
    return true;
  }

  void measure_both(Subtree& left, Subtree& right) {
    left.box = right.box = left.centres2 = right.centres2 = {};
    left.measure(references_), right.measure(references_);
  }

  // Moves the sides to the ends of the slots and shares the slack by their counts.
  void place(const Subtree& at, uint32_t left_count, uint32_t right_count, Subtree& left, Subtree& right) {
    const uint32_t slack = at.last - at.first - left_count - right_count;
    const uint32_t left_slack = uint32_t(uint64_t(slack) * left_count / (left_count + right_count));
    const uint32_t border = at.first + left_count + left_slack;
    left.first = at.first, left.last = border, left.begin = at.first, left.count = left_count;
    right.first = border, right.last = at.last, right.begin = at.last - right_count, right.count = right_count;
    if (slack > 0) {
      // The references begin at the low end or end at the high end, so one of these moves nothing.
      const uint32_t right_from = at.begin + left_count;
      if (right.begin != right_from)
        std::memmove(references_ + right.begin, references_ + right_from, right_count * sizeof(BoxReference));
      if (left.begin != at.begin)
        std::memmove(references_ + left.begin, references_ + at.begin, left_count * sizeof(BoxReference));
    }
    left.node = 2 * border, right.node = 2 * border + 1;
    left.depth = right.depth = at.depth + 1;
  }

  void sort_halves(const Subtree& at) {
    const Aabb centres = at.centres2.aabb();
    const glm::vec3 size = centres.max - centres.min;
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    BoxReference* low = references_ + at.begin;
    std::nth_element(low, low + at.count / 2, low + at.count, [axis](const BoxReference& a, const BoxReference& b) {
      const float x = a.low[axis] + a.high[axis], y = b.low[axis] + b.high[axis];
      return x != y ? x < y : a.id < b.id;
    });
  }

  BinaryTree& tree_;
  std::span<const TriangleCorners> triangles_;
  const BvhOptions& options_;
  BoxReference* references_;
  float root_area_ = 0;
  tbb::task_group group_;
  std::atomic<uint32_t> depth_ = 0;
  std::atomic<size_t> leaf_references_ = 0, leaves_ = 0;
};

}  // namespace

BoxReference reference_to(const TriangleCorners& t, uint32_t id) {
  const F4 a = F4::load3(&t.corner[0].x), b = F4::load3(&t.corner[1].x), c = F4::load3(&t.corner[2].x);
  const F4 low = min(min(a, b), c), high = max(max(a, b), c);
  const F4 margin = F4::all((high - low).largest3() * rounding_fraction);
  BoxReference r;
  (low - margin).store(r.low);
  (high + margin).store(r.high);
  r.id = id, r.unused = 0;
  return r;
}

BinaryTree build_tree(std::span<const BoxReference> boxes, std::span<const TriangleCorners> triangles,
                      const BvhOptions& options) {
  CHECK(options.buckets >= least_buckets && options.buckets <= most_buckets && options.max_leaf >= 1 &&
        options.max_leaf <= most_in_leaf && options.depth <= most_depth);
  BinaryTree tree;
  if (boxes.empty()) return tree;
  const bool may_cut = splits_space(options.builder) && !triangles.empty();
  const size_t slack = may_cut ? size_t(double(boxes.size()) * double(options.split_budget)) : 0;
  CHECK_MSG(boxes.size() + slack < (1u << 30), "more triangles than the builder's 32-bit indices reach");
  tree.references.resize(boxes.size() + slack);
  tree.nodes.resize(2 * tree.references.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, boxes.size(), 1 << 16), [&](const auto& range) {
    std::copy(boxes.begin() + range.begin(), boxes.begin() + range.end(), tree.references.begin() + range.begin());
  });
  Subtree root{0, 0, uint32_t(tree.references.size()), 0, uint32_t(boxes.size()), 0, {}, {}};
  root.measure(tree.references.data());
  Builder(tree, triangles, options).build(root);
  return tree;
}

double sah_cost(const BinaryTree& tree, const BvhOptions& options) {
  if (tree.empty()) return 0;
  double sum = 0;
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    const BinaryNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    sum +=
        double(node.half_area()) * double(node.inner ? options.node_cost : tests_of(node.count, options.block_shift));
    if (node.inner) stack.push_back(node.first), stack.push_back(node.first + 1);
  }
  const double root = double(tree.nodes[0].half_area());
  return root > 0 ? sum / root : double(tree.reference_count);
}

}  // namespace candela
