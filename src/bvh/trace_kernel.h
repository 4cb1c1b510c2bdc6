#pragma once
// The traversal itself, compiled once per instruction set: included by trace_avx512.cpp, trace_avx2.cpp,
// trace_sse2.cpp and trace_scalar.cpp alone. Slabs after Ize, "Robust BVH Ray Traversal", 2013; triangles after Woop,
// Benthin, Wald 2013 (see triangle.h, whose operations and order these are).
#include <bit>
#include <cstdint>

#include "bvh/simd.h"
#include "bvh/trace.h"

namespace candela {
namespace {

// Wide trees are at most 92 deep, and a level leaves at most seven siblings waiting.
constexpr int stack_size = 7 * 92 + 8;
// Ize's factor covers the roundings of both slabs' t; the rest covers how far a triangle's own t may lie before its
// box's.
constexpr float slab_slack = 1.000001f;
constexpr float smallest_determinant = 1e-20f, largest_determinant = 1e30f;  // as in triangle.h

inline float magnitude(float x) { return std::bit_cast<float>(std::bit_cast<uint32_t>(x) & 0x7fffffffu); }

// A child to visit, as one number that sorts by distance: its bits as those of a float that is not negative, above the
// child reference. (Below zero, for rays with such a t_min, the order is no longer the best one, but all are visited.)
using Waiting = uint64_t;
inline Waiting waiting(float near, uint32_t child) { return uint64_t(std::bit_cast<uint32_t>(near)) << 32 | child; }
inline uint32_t child_of(Waiting w) { return uint32_t(w); }
inline float near_of(Waiting w) { return std::bit_cast<float>(uint32_t(w >> 32)); }
// The nearer into a. Without branches, whose outcome nobody could guess.
inline void sort2(Waiting& a, Waiting& b) {
  const Waiting low = a < b ? a : b, high = a < b ? b : a;
  a = low, b = high;
}

inline uint32_t negative(float f) { return std::bit_cast<uint32_t>(f) >> 31; }

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

// A ray as triangles take it: as shear_of in triangle.h, without branches, which incoherent rays would guess wrong.
struct TriangleRay {
  uint32_t x, y, z;  // axes of the sheared space
  F4 origin[3], sx, sy, sz, least_t;
  TriangleRay(const KernelRay& ray, F4 inverse) : least_t(F4::all(ray.t_min)) {
    const float(&d)[3] = ray.direction;
    const float a0 = magnitude(d[0]), a1 = magnitude(d[1]), a2 = magnitude(d[2]);
    const uint32_t first = a0 > a1, last = !((a0 > a1 ? a0 : a1) > a2);
    static constexpr uint32_t after[3] = {1, 2, 0};
    z = last << 1 | ((first | last) ^ 1u);
    const uint32_t one = after[z], other = after[one], swap = (one ^ other) & (0u - negative(d[z]));
    x = one ^ swap, y = other ^ swap;
    const uint32_t axes[3] = {x, y, z};
    for (int i = 0; i < 3; ++i) origin[i] = F4::all(ray.origin[axes[i]]);
    float inverses[4];
    inverse.store(inverses);
    sz = F4::all(inverses[z]), sx = F4::all(d[x]) * sz, sy = F4::all(d[y]) * sz;
  }
};

struct Sheared {
  F4 x, y, z;
};

inline bool meet_in_double(const float (&a)[3], const float (&b)[3], const float (&c)[3], const KernelRay& ray,
                           KernelHit& hit) {
  const double u = double(c[0]) * double(b[1]) - double(c[1]) * double(b[0]);
  const double v = double(a[0]) * double(c[1]) - double(a[1]) * double(c[0]);
  const double w = double(b[0]) * double(a[1]) - double(b[1]) * double(a[0]);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double determinant = u + v + w;
  if (!(determinant != 0)) return false;
  const float t = float((u * double(a[2]) + v * double(b[2]) + w * double(c[2])) / determinant);
  if (!(t >= ray.t_min && t <= ray.t_max)) return false;
  hit.t = t, hit.u = float(v / determinant), hit.v = float(w / determinant), hit.clockwise = determinant < 0;
  return true;
}

// What a search does with a hit within the ray's limits, whose numbers go from registers to where they are kept: copied
// as a whole they would have to wait for one another. True: it is taken.
inline bool take(const KernelTree& tree, float t, float u, float v, uint32_t id, bool clockwise, KernelRay& ray,
                 KernelSearch& search) {
  KernelHit& best = search.best;
  if (t == best.t && best.id != no_triangle) {
    if (search.place == search.best_place ? id >= best.id : search.loses_tie(search, {t, u, v, id, clockwise}))
      return false;
  }
  const uint8_t doubt = tree.doubts ? tree.doubts[id] : tree.doubt;
  if ((doubt & doubt_turning(clockwise)) && !search.accept(search, {t, u, v, id, clockwise})) return false;
  if (tree.wanted) __builtin_prefetch(tree.wanted + id);
  best.t = t, best.u = u, best.v = v, best.id = id, best.clockwise = clockwise;
  search.best_place = search.place, ray.t_max = t;
  return true;
}

// Tests a block. True: a search for any hit ends, or another one has a nearer hit.
template <bool any, bool counted>
inline bool meet_block(const KernelTree& tree, const TriangleBlock& block, const TriangleRay& p, KernelRay& ray,
                       KernelSearch& search, KernelCounts* counts) {
  Sheared s[3];
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const F4 z = F4::load(block.corner[k][p.z]) - p.origin[2];
    s[k].x = (F4::load(block.corner[k][p.x]) - p.origin[0]) - p.sx * z;
    s[k].y = (F4::load(block.corner[k][p.y]) - p.origin[1]) - p.sy * z;
    s[k].z = z;
  }
  const F4 u = s[2].x * s[1].y - s[2].y * s[1].x;
  const F4 v = s[0].x * s[2].y - s[0].y * s[2].x;
  const F4 w = s[1].x * s[0].y - s[1].y * s[0].x;
  const F4 zero = F4::all(0.0f);
  if constexpr (counted) counts->triangles += uint64_t(std::popcount(~equal_ints(block.id, no_triangle) & 15u));
  uint32_t candidates = 15u & ~(less(min(min(u, v), w), zero) & less(zero, max(max(u, v), w))).bits();
  if (candidates == 0) return false;
  candidates &= ~equal_ints(block.id, no_triangle);

  const F4 determinant = (u + v) + w, size = absolute(determinant);
  const F4 least = min(min(absolute(u), absolute(v)), absolute(w));
  const uint32_t exact = (less(zero, least) & less_equal(F4::all(smallest_determinant), size) &
                          less_equal(size, F4::all(largest_determinant)))
                             .bits();
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) s[k].z = p.sz * s[k].z;
  const F4 t = ((u * s[0].z + v * s[1].z) + w * s[2].z) / determinant;
  candidates &= ~exact | (less_equal(p.least_t, t) & less_equal(t, F4::all(ray.t_max))).bits();
  if (candidates == 0) return false;
  if (any && !tree.doubts && !tree.doubt && (candidates & exact) != 0) return true;
  float ts[4], vs[4], ws[4], determinants[4];
  t.store(ts), v.store(vs), w.store(ws), determinant.store(determinants);
  bool taken = false;
  for (; candidates != 0; candidates &= candidates - 1) {
    const int lane = std::countr_zero(candidates);
    const float d = determinants[lane];
    if (exact >> lane & 1u) {
      if (!(ts[lane] <= ray.t_max)) continue;  // another lane has shortened the ray
      if (!take(tree, ts[lane], vs[lane] / d, ws[lane] / d, block.id[lane], d < 0, ray, search)) continue;
    } else {
      float corner[3][3];
      for (int k = 0; k < 3; ++k) {
        float x[4], y[4], z[4];
        s[k].x.store(x), s[k].y.store(y), s[k].z.store(z);
        corner[k][0] = x[lane], corner[k][1] = y[lane], corner[k][2] = z[lane];
      }
      KernelHit hit;
      if (!meet_in_double(corner[0], corner[1], corner[2], ray, hit)) continue;
      if (!take(tree, hit.t, hit.u, hit.v, block.id[lane], hit.clockwise, ray, search)) continue;
    }
    if (any) return true;
    taken = true;
  }
  return taken;
}

// What stands in a leaf. As meet_block.
template <bool over_triangles, bool any, bool counted>
inline bool meet_leaf(const KernelTree& tree, uint32_t leaf, const TriangleRay& p, KernelRay& ray, KernelSearch& search,
                      KernelCounts* counts) {
  const uint32_t first = first_of_leaf(leaf), count = count_of_leaf(leaf);
  bool taken = false;
  for (uint32_t i = first; i < first + count; ++i) {
    if constexpr (over_triangles)
      taken |= meet_block<any, counted>(tree, tree.blocks[i], p, ray, search, counts);
    else
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
void traverse_nearest(const KernelTree& tree, KernelRay& ray, F4 origin, F4 inverse, KernelSearch& search,
                      KernelCounts* counts) {
  BoxRay<plain> box_ray(ray, origin, inverse);
  const TriangleRay triangle_ray(ray, inverse);
  Waiting stack[stack_size];
  Waiting* top = stack;
  uint32_t child = 0;
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
bool traverse_any(const KernelTree& tree, KernelRay& ray, F4 origin, F4 inverse, KernelSearch& search,
                  KernelCounts* counts) {
  const BoxRay<plain> box_ray(ray, origin, inverse);
  const TriangleRay triangle_ray(ray, inverse);
  uint32_t stack[stack_size];
  uint32_t* top = stack;
  uint32_t child = 0;
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

template <bool over_triangles, bool counted, bool plain>
bool traverse(const KernelTree& tree, KernelRay& ray, F4 origin, F4 inverse, KernelSearch& search, bool any,
              KernelCounts* counts) {
  if (any) return traverse_any<over_triangles, counted, plain>(tree, ray, origin, inverse, search, counts);
  traverse_nearest<over_triangles, counted, plain>(tree, ray, origin, inverse, search, counts);
  return false;
}

// Counts are those of the boxes as every instruction set tests them.
template <bool over_triangles>
bool trace(const KernelTree& tree, KernelRay& ray, KernelSearch& search, bool any, KernelCounts* counts) {
  const F4 origin = F4::load(ray.origin), direction = F4::load(ray.direction);  // the fourth lanes of no meaning
  const F4 inverse = F4::all(1.0f) / direction;
  if (counts) return traverse<over_triangles, true, false>(tree, ray, origin, inverse, search, any, counts);
  if (is_plain(origin, direction))
    return traverse<over_triangles, false, true>(tree, ray, origin, inverse, search, any, nullptr);
  return traverse<over_triangles, false, false>(tree, ray, origin, inverse, search, any, nullptr);
}

}  // namespace
}  // namespace candela
