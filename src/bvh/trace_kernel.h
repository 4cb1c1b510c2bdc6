#pragma once
// The traversal itself, compiled once per instruction set: included by trace_avx2.cpp, trace_sse2.cpp and
// trace_scalar.cpp alone. Slabs after Ize, "Robust BVH Ray Traversal", 2013; triangles after Woop, Benthin, Wald 2013
// (see triangle.h, whose operations and order these are).
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

struct Prepared {  // a ray, spread over lanes
  F8 origin[3], inverse[3], far_inverse[3], t_min;
  uint32_t near_row[3], far_row[3];  // of WideNode::bounds, in floats
  uint32_t x, y, z;                  // axes of the sheared space
  F4 shear_origin[3], sx, sy, sz, least_t;
  explicit Prepared(const KernelRay& ray) : t_min(F8::all(ray.t_min)), least_t(F4::all(ray.t_min)) {
    const float(&d)[3] = ray.direction;
    float inverses[4];  // the fourth of no meaning
    (F4::all(1.0f) / F4::load3(d)).store(inverses);
    for (uint32_t a = 0; a < 3; ++a) {
      origin[a] = F8::all(ray.origin[a]), inverse[a] = F8::all(inverses[a]);
      far_inverse[a] = F8::all(inverses[a] * slab_slack);
      near_row[a] = (2 * a + negative(d[a])) * wide_children;
      far_row[a] = (2 * a + 1 - negative(d[a])) * wide_children;
    }
    // As shear_of in triangle.h, without branches: incoherent rays would guess them wrong.
    const float a0 = magnitude(d[0]), a1 = magnitude(d[1]), a2 = magnitude(d[2]);
    const uint32_t first = a0 > a1, last = !((a0 > a1 ? a0 : a1) > a2);
    static constexpr uint32_t after[3] = {1, 2, 0};
    z = last << 1 | ((first | last) ^ 1u);
    const uint32_t one = after[z], other = after[one], swap = (one ^ other) & (0u - negative(d[z]));
    x = one ^ swap, y = other ^ swap;
    const uint32_t axes[3] = {x, y, z};
    for (int i = 0; i < 3; ++i) shear_origin[i] = F4::all(ray.origin[axes[i]]);
    sz = F4::all(inverses[z]), sx = F4::all(d[x]) * sz, sy = F4::all(d[y]) * sz;
  }

 private:
  static uint32_t negative(float f) { return std::bit_cast<uint32_t>(f) >> 31; }
};

// Bit per child whose box the ray meets. A slab's 0 * infinity (the origin in the plane of a slab that the ray runs
// along) is NaN, which min and max drop: the slab then does not limit.
inline uint32_t meet_boxes(const WideNode& node, const Prepared& p, float t_max, F8& near) {
  const float* bounds = node.bounds[0];
  F8 begin = p.t_min, end = F8::all(t_max * slab_slack);
#pragma GCC unroll 3
  for (int a = 0; a < 3; ++a) {
    begin = max((F8::load(bounds + p.near_row[a]) - p.origin[a]) * p.inverse[a], begin);
    end = min((F8::load(bounds + p.far_row[a]) - p.origin[a]) * p.far_inverse[a], end);
  }
  near = begin;
  return less_equal(begin, end);
}

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

template <bool any, bool counted>
inline bool meet_block(const TriangleBlock& block, const Prepared& p, KernelRay& ray, KernelCaller& caller,
                       KernelCounts* counts) {
  Sheared s[3];
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const F4 z = F4::load(block.corner[k][p.z]) - p.shear_origin[2];
    s[k].x = (F4::load(block.corner[k][p.x]) - p.shear_origin[0]) - p.sx * z;
    s[k].y = (F4::load(block.corner[k][p.y]) - p.shear_origin[1]) - p.sy * z;
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
  if (any && !caller.accept && (candidates & exact) != 0) return true;
  float ts[4], us[4], vs[4], size_sign[4];
  t.store(ts), (v / determinant).store(us), (w / determinant).store(vs), determinant.store(size_sign);
  for (; candidates != 0; candidates &= candidates - 1) {
    const int lane = std::countr_zero(candidates);
    KernelHit hit{ts[lane], us[lane], vs[lane], block.id[lane], size_sign[lane] < 0};
    if (exact >> lane & 1u) {
      if (!(hit.t <= ray.t_max)) continue;  // another lane has shortened the ray
    } else {
      float corner[3][3];
      for (int k = 0; k < 3; ++k) {
        float x[4], y[4], z[4];
        s[k].x.store(x), s[k].y.store(y), s[k].z.store(z);
        corner[k][0] = x[lane], corner[k][1] = y[lane], corner[k][2] = z[lane];
      }
      if (!meet_in_double(corner[0], corner[1], corner[2], ray, hit)) continue;
    }
    if (any && !caller.accept) return true;
    if (!caller.accept(caller, hit)) continue;
    if (any) return true;
    ray.t_max = hit.t;
  }
  return false;
}

// What stands in a leaf.
template <bool over_triangles, bool any, bool counted>
inline bool meet_leaf(const KernelTree& tree, uint32_t leaf, const Prepared& p, KernelRay& ray, KernelCaller& caller,
                      KernelCounts* counts) {
  const uint32_t first = first_of_leaf(leaf), count = count_of_leaf(leaf);
  for (uint32_t i = first; i < first + count; ++i) {
    if constexpr (over_triangles) {
      if (meet_block<any, counted>(tree.blocks[i], p, ray, caller, counts)) return true;
    } else {
      if (caller.enter(caller, tree.indices[i], ray)) return true;
    }
  }
  return false;
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

template <bool over_triangles, bool counted>
bool traverse_nearest(const KernelTree& tree, KernelRay& ray, KernelCaller& caller, KernelCounts* counts) {
  const Prepared p(ray);
  Waiting stack[stack_size];
  Waiting* top = stack;
  uint32_t child = 0;
  while (true) {
    // Down to a leaf, nearest child first.
    while (!(child & leaf_bit)) {
      const WideNode& node = tree.nodes[child];
      F8 begin;
      uint32_t met = meet_boxes(node, p, ray.t_max, begin);
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
    if (meet_leaf<over_triangles, false, counted>(tree, child, p, ray, caller, counts)) return true;
  next:
    do {
      if (top == stack) return false;
      --top;
    } while (!(near_of(*top) <= ray.t_max * slab_slack));
    child = child_of(*top);
  }
}

// The ray never gets shorter, so distances do not matter. The last child is the largest (wide_tree.cpp), hence the
// likeliest to hold a hit: it comes first.
template <bool over_triangles, bool counted>
bool traverse_any(const KernelTree& tree, KernelRay& ray, KernelCaller& caller, KernelCounts* counts) {
  const Prepared p(ray);
  uint32_t stack[stack_size];
  uint32_t* top = stack;
  uint32_t child = 0;
  while (true) {
    while (!(child & leaf_bit)) {
      const WideNode& node = tree.nodes[child];
      F8 begin;
      uint32_t met = meet_boxes(node, p, ray.t_max, begin);
      if constexpr (counted) count_node(node, counts);
      if (met == 0) goto next;
      for (; met != 0; met &= met - 1) *top++ = node.child[std::countr_zero(met)];
      child = *--top;
    }
    if (meet_leaf<over_triangles, true, counted>(tree, child, p, ray, caller, counts)) return true;
  next:
    if (top == stack) return false;
    child = *--top;
  }
}

template <bool over_triangles>
bool trace(const KernelTree& tree, KernelRay& ray, KernelCaller& caller, bool any, KernelCounts* counts) {
  if (any)
    return counts ? traverse_any<over_triangles, true>(tree, ray, caller, counts)
                  : traverse_any<over_triangles, false>(tree, ray, caller, counts);
  return counts ? traverse_nearest<over_triangles, true>(tree, ray, caller, counts)
                : traverse_nearest<over_triangles, false>(tree, ray, caller, counts);
}

}  // namespace
}  // namespace candela
