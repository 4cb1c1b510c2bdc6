#pragma once
// The traversal itself, compiled once per instruction set: included by trace_avx512.cpp, trace_avx2.cpp,
// trace_sse2.cpp and trace_scalar.cpp alone. Slabs after Ize, "Robust BVH Ray Traversal", 2013.
#include "bvh/trace_triangle.h"

namespace candela {
namespace {

// Wide trees are at most 92 deep, and a level leaves at most seven siblings waiting.
constexpr int stack_size = 7 * 92 + 8;
// Ize's factor covers the roundings of both slabs' t; the rest covers how far a triangle's own t may lie before its
// box's.
constexpr float slab_slack = 1.000001f;

// A child to visit, as one number that sorts by distance: its bits as those of a float that is not negative, above the
// child reference. (Below zero, for rays with such a t_min, the order is no longer the best one, but all are visited.)
using Waiting = uint64_t;
inline Waiting waiting(float near, uint32_t child) { return uint64_t(std::bit_cast<uint32_t>(near)) << 32 | child; }
inline uint32_t child_of(Waiting w) { return uint32_t(w); }
inline float near_of(Waiting w) { return std::bit_cast<float>(uint32_t(w >> 32)); }
// The nearer into a. Without branches, which could not be predicted.
inline void sort2(Waiting& a, Waiting& b) {
  const Waiting low = a < b ? a : b, high = a < b ? b : a;
  a = low, b = high;
}

// A ray as boxes take it, spread over lanes. By planes less origin, times the inverse; or for what is `plain` by one
// multiplication and addition: plane * inverse - origin * inverse, where the second product is moved outwards by more
// than both may be off, so that no box is missed. `plain`: numbers so far from the ends that nothing overflows.
template <bool plain>
struct BoxRay {
  F8 near_inverse[3], far_inverse[3], near_offset[3], far_offset[3];
  F8 begin, end;
  uint32_t near_row[3], far_row[3];  // of WideNode::bounds, in floats
  BoxRay(const KernelRay& ray, F4 origin, F4 inverse) : begin(F8::all(ray.t_min)) {
    const F4 far = inverse * F4::all(slab_slack), outwards = F4::all(0x1p-22f);
    float nears[4], fars[4], near_offsets[4], far_offsets[4];
    inverse.store(nears), far.store(fars);
    if constexpr (plain) {
      const F4 near_from = origin * inverse, far_from = origin * far;
      (F4::all(0) - near_from - absolute(near_from) * outwards).store(near_offsets);
      (absolute(far_from) * outwards - far_from).store(far_offsets);
    } else {
      origin.store(near_offsets), origin.store(far_offsets);
    }
    for (uint32_t a = 0; a < 3; ++a) {
      near_inverse[a] = F8::all(nears[a]), far_inverse[a] = F8::all(fars[a]);
      near_offset[a] = F8::all(near_offsets[a]), far_offset[a] = F8::all(far_offsets[a]);
      near_row[a] = (2 * a + negative(ray.direction[a])) * wide_children;
      far_row[a] = (2 * a + 1 - negative(ray.direction[a])) * wide_children;
    }
    shorten(ray.t_max);
  }
  void shorten(float t_max) { end = F8::all(t_max * slab_slack); }
};

inline bool is_plain(F4 origin, F4 direction) {
  const F4 size = absolute(direction);
  return ((less_equal(F4::all(0x1p-40f), size) & less_equal(size, F4::all(0x1p40f)) &
           less_equal(absolute(origin), F4::all(0x1p60f)))
              .bits() &
          7u) == 7u;
}

// Bit per child whose box the ray meets. Where it is not plain, a slab's 0 * infinity (the origin in the plane of a
// slab that the ray runs along) is NaN, which min and max drop: the slab then does not limit.
template <bool plain>
inline uint32_t meet_boxes(const WideNode& node, const BoxRay<plain>& r, F8& near) {
  const float* bounds = node.bounds[0];
  F8 begin[3], end[3];
#pragma GCC unroll 3
  for (int a = 0; a < 3; ++a) {
    const F8 low = F8::load(bounds + r.near_row[a]), high = F8::load(bounds + r.far_row[a]);
    if constexpr (plain) {
      begin[a] = multiply_add(low, r.near_inverse[a], r.near_offset[a]);
      end[a] = multiply_add(high, r.far_inverse[a], r.far_offset[a]);
    } else {
      begin[a] = (low - r.near_offset[a]) * r.near_inverse[a];
      end[a] = (high - r.far_offset[a]) * r.far_inverse[a];
    }
  }
  near = plain ? max(max(begin[0], begin[1]), max(begin[2], r.begin))
               : max(begin[2], max(begin[1], max(begin[0], r.begin)));
  const F8 far = plain ? min(min(end[0], end[1]), min(end[2], r.end)) : min(end[2], min(end[1], min(end[0], r.end)));
  return less_equal(near, far);
}

// What stands in a leaf. As meet_block.
template <bool over_triangles, bool any, bool counted>
inline bool meet_leaf(const KernelTree& tree, uint32_t leaf, const ShearedRays<F4>& p, KernelRay& ray,
                      KernelSearch& search, KernelCounts* counts) {
  const uint32_t first = first_of_leaf(leaf), count = count_of_leaf(leaf);
  bool taken = false;
  for (uint32_t i = first; i < first + count; ++i) {
    if constexpr (over_triangles) {
      if constexpr (counted)
        counts->triangles += uint64_t(std::popcount(~equal_ints(tree.blocks[i].id, no_triangle) & 15u));
      taken |= meet_block<any>(tree, tree.blocks[i], p, ray, search);
    } else
      taken |= search.enter(search, tree.indices[i], ray);
    if (any && taken) return true;
  }
  return taken;
}

inline void count_node(const WideNode& node, KernelCounts* counts) {
  ++counts->nodes;
  for (uint32_t c : node.child) counts->boxes += c != no_child;
}

// Starts fetching what a child reference stands for: big trees do not fit into the caches.
template <bool over_triangles>
inline void prefetch(const KernelTree& tree, uint32_t child) {
  const char* at;
  if (!(child & leaf_bit))
    at = reinterpret_cast<const char*>(tree.nodes + child);
  else if (over_triangles)
    at = reinterpret_cast<const char*>(tree.blocks + first_of_leaf(child));
  else
    return;
  __builtin_prefetch(at), __builtin_prefetch(at + 64), __builtin_prefetch(at + 128);
  if (!(child & leaf_bit)) __builtin_prefetch(at + 192);
}

template <bool over_triangles, bool counted, bool plain>
void traverse_nearest(const KernelTree& tree, uint32_t child, KernelRay& ray, F4 origin, F4 inverse,
                      KernelSearch& search, KernelCounts* counts) {
  BoxRay<plain> box_ray(ray, origin, inverse);
  const ShearedRays<F4> triangle_ray = sheared(ray, inverse);
  Waiting stack[stack_size];
  Waiting* top = stack;
  while (true) {
    // Down to a leaf, nearest child first.
    while (!(child & leaf_bit)) {
      const WideNode& node = tree.nodes[child];
      F8 begin;
      uint32_t met = meet_boxes(node, box_ray, begin);
      if constexpr (counted) count_node(node, counts);
      if (met == 0) goto next;
      alignas(32) float near[wide_children];
      begin.store(near);
      const auto next_met = [&] {
        const int lane = std::countr_zero(met);
        met &= met - 1;
        prefetch<over_triangles>(tree, node.child[lane]);
        return waiting(near[lane], node.child[lane]);
      };
      Waiting a = next_met();
      if (met == 0) {
        child = child_of(a);
        continue;
      }
      Waiting b = next_met();
      sort2(a, b);
      if (met == 0) {
        *top++ = b;
        child = child_of(a);
        continue;
      }
      Waiting c = next_met();
      sort2(b, c), sort2(a, b);
      if (met == 0) {
        *top++ = c, *top++ = b;
        child = child_of(a);
        continue;
      }
      // Four and more: the farthest lowest.
      Waiting* const first = top;
      *top++ = c, *top++ = b;
      do {
        Waiting d = next_met();
        sort2(a, d);
        Waiting* at = top++;
        for (; at > first && at[-1] < d; --at) at[0] = at[-1];
        *at = d;
      } while (met != 0);
      child = child_of(a);
    }
    if (meet_leaf<over_triangles, false, counted>(tree, child, triangle_ray, ray, search, counts))
      box_ray.shorten(ray.t_max);
  next:
    const float end = ray.t_max * slab_slack;
    do {
      if (top == stack) return;
      --top;
    } while (!(near_of(*top) <= end));
    child = child_of(*top);
  }
}

// The ray never gets shorter, so distances do not matter. The last child is the largest (wide_tree.cpp), hence the
// likeliest to hold a hit: it comes first.
template <bool over_triangles, bool counted, bool plain>
bool traverse_any(const KernelTree& tree, uint32_t child, KernelRay& ray, F4 origin, F4 inverse, KernelSearch& search,
                  KernelCounts* counts) {
  const BoxRay<plain> box_ray(ray, origin, inverse);
  const ShearedRays<F4> triangle_ray = sheared(ray, inverse);
  uint32_t stack[stack_size];
  uint32_t* top = stack;
  while (true) {
    while (!(child & leaf_bit)) {
      const WideNode& node = tree.nodes[child];
      F8 begin;
      uint32_t met = meet_boxes(node, box_ray, begin);
      if constexpr (counted) count_node(node, counts);
      if (met == 0) goto next;
      for (; met != 0; met &= met - 1) {
        *top++ = node.child[std::countr_zero(met)];
        prefetch<over_triangles>(tree, top[-1]);
      }
      child = *--top;
    }
    if (meet_leaf<over_triangles, true, counted>(tree, child, triangle_ray, ray, search, counts)) return true;
  next:
    if (top == stack) return false;
    child = *--top;
  }
}

// child: of the subtree to search.
template <bool over_triangles, bool counted, bool plain>
bool traverse(const KernelTree& tree, uint32_t child, KernelRay& ray, F4 origin, F4 inverse, KernelSearch& search,
              bool any, KernelCounts* counts) {
  if (any) return traverse_any<over_triangles, counted, plain>(tree, child, ray, origin, inverse, search, counts);
  traverse_nearest<over_triangles, counted, plain>(tree, child, ray, origin, inverse, search, counts);
  return false;
}

// Counts are those of the boxes as every instruction set tests them.
template <bool over_triangles>
bool trace(const KernelTree& tree, KernelRay& ray, KernelSearch& search, bool any, KernelCounts* counts) {
  const F4 origin = F4::load(ray.origin), direction = F4::load(ray.direction);  // the fourth lanes of no meaning
  const F4 inverse = F4::all(1.0f) / direction;
  if (counts) return traverse<over_triangles, true, false>(tree, 0, ray, origin, inverse, search, any, counts);
  if (is_plain(origin, direction))
    return traverse<over_triangles, false, true>(tree, 0, ray, origin, inverse, search, any, nullptr);
  return traverse<over_triangles, false, false>(tree, 0, ray, origin, inverse, search, any, nullptr);
}

}  // namespace
}  // namespace candela
