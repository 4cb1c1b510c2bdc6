#pragma once
// Triangles of the traversal kernels: a block's triangles against one ray, or one triangle against a packet's rays, by
// the same operations lane by lane, after Woop, Benthin, Wald 2013 (see triangle.h, whose operations and order these
// are).
#include <bit>
#include <cstdint>
#include <type_traits>

#include "bvh/simd.h"
#include "bvh/trace.h"

namespace candela {
namespace {

constexpr float smallest_determinant = 1e-20f, largest_determinant = 1e30f;  // as in triangle.h

inline float magnitude(float x) { return std::bit_cast<float>(std::bit_cast<uint32_t>(x) & 0x7fffffffu); }
inline uint32_t negative(float f) { return std::bit_cast<uint32_t>(f) >> 31; }

// Axes of the sheared space: as shear_of in triangle.h, without branches, which incoherent rays would guess wrong.
struct ShearAxes {
  uint32_t x, y, z;
  explicit ShearAxes(const float (&d)[3]) {
    const float a0 = magnitude(d[0]), a1 = magnitude(d[1]), a2 = magnitude(d[2]);
    const uint32_t first = a0 > a1, last = !((a0 > a1 ? a0 : a1) > a2);
    static constexpr uint32_t after[3] = {1, 2, 0};
    z = last << 1 | ((first | last) ^ 1u);
    const uint32_t one = after[z], other = after[one], swap = (one ^ other) & (0u - negative(d[z]));
    x = one ^ swap, y = other ^ swap;
  }
};

// Rays as triangles take them: one in all lanes, or one a lane.
template <class F>
struct ShearedRays {
  ShearAxes axes;
  F origin[3], sx, sy, sz, least_t;
};

inline ShearedRays<F4> sheared(const KernelRay& ray, F4 inverse) {
  const ShearAxes axes(ray.direction);
  float inverses[4];
  inverse.store(inverses);
  const F4 sz = F4::all(inverses[axes.z]);
  return {axes,
          {F4::all(ray.origin[axes.x]), F4::all(ray.origin[axes.y]), F4::all(ray.origin[axes.z])},
          F4::all(ray.direction[axes.x]) * sz,
          F4::all(ray.direction[axes.y]) * sz,
          sz,
          F4::all(ray.t_min)};
}

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

// Whom a lane's hit belongs to.
struct LaneHit {
  uint32_t id;
  KernelRay& ray;
  KernelSearch& search;
};

// Tests triangles against rays, lane by lane. corner(k, axis): of the k-th corners; lanes(): those that hold both a
// triangle and a ray; t_max: of the rays; at(lane): a LaneHit. Returns the lanes whose hits are taken; of one ray that
// searches any hit the first.
template <class F, bool any, class Corner, class Lanes, class At>
inline uint32_t meet(const KernelTree& tree, const ShearedRays<F>& p, Corner&& corner, Lanes&& lanes, F t_max,
                     At&& at) {
  constexpr uint32_t width = sizeof(F) / sizeof(float), all = (1u << width) - 1;
  constexpr bool one_ray = std::is_same_v<F, F4>;
  F x[3], y[3], z[3];
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    z[k] = corner(k, p.axes.z) - p.origin[2];
    x[k] = (corner(k, p.axes.x) - p.origin[0]) - p.sx * z[k];
    y[k] = (corner(k, p.axes.y) - p.origin[1]) - p.sy * z[k];
  }
  const F u = x[2] * y[1] - y[2] * x[1];
  const F v = x[0] * y[2] - y[0] * x[2];
  const F w = x[1] * y[0] - y[1] * x[0];
  const F zero = F::all(0.0f);
  uint32_t candidates = all & ~bits_of(less(min(min(u, v), w), zero) & less(zero, max(max(u, v), w)));
  if (candidates == 0) return 0;
  candidates &= lanes();

  const F determinant = (u + v) + w, size = absolute(determinant);
  const F least_edge = min(min(absolute(u), absolute(v)), absolute(w));
  const uint32_t exact = bits_of(less(zero, least_edge) & less_equal(F::all(smallest_determinant), size) &
                                 less_equal(size, F::all(largest_determinant)));
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) z[k] = p.sz * z[k];
  const F t = ((u * z[0] + v * z[1]) + w * z[2]) / determinant;
  candidates &= ~exact | bits_of(less_equal(p.least_t, t) & less_equal(t, t_max));
  if (candidates == 0) return 0;
  uint32_t taken = 0;
  if (any && !tree.doubts && !tree.doubt) {
    taken = candidates & exact;
    candidates &= ~exact;
    if (candidates == 0 || (one_ray && taken != 0)) return taken;
  }
  alignas(64) float ts[width], vs[width], ws[width], determinants[width];
  t.store(ts), (v / determinant).store(vs), (w / determinant).store(ws), determinant.store(determinants);
  for (; candidates != 0; candidates &= candidates - 1) {
    const int lane = std::countr_zero(candidates);
    const LaneHit of = at(lane);
    if (exact >> lane & 1u) {
      if (!(ts[lane] <= of.ray.t_max)) continue;  // another lane has shortened the ray
      if (!take(tree, ts[lane], vs[lane], ws[lane], of.id, determinants[lane] < 0, of.ray, of.search)) continue;
    } else {
      float corners[3][3];
      for (int k = 0; k < 3; ++k) {
        alignas(64) float xs[width], ys[width], zs[width];
        x[k].store(xs), y[k].store(ys), z[k].store(zs);
        corners[k][0] = xs[lane], corners[k][1] = ys[lane], corners[k][2] = zs[lane];
      }
      KernelHit hit;
      if (!meet_in_double(corners[0], corners[1], corners[2], of.ray, hit)) continue;
      if (!take(tree, hit.t, hit.u, hit.v, of.id, hit.clockwise, of.ray, of.search)) continue;
    }
    taken |= 1u << lane;
    if (any && one_ray) return taken;
  }
  return taken;
}

// A block against one ray. True: a search for any hit ends, or another one has a nearer hit.
template <bool any>
inline bool meet_block(const KernelTree& tree, const TriangleBlock& block, const ShearedRays<F4>& p, KernelRay& ray,
                       KernelSearch& search) {
  return meet<F4, any>(
             tree, p, [&](int k, uint32_t axis) { return F4::load(block.corner[k][axis]); },
             [&] { return ~equal_ints(block.id, no_triangle); }, F4::all(ray.t_max),
             [&](int lane) {
               return LaneHit{block.id[lane], ray, search};
             }) != 0;
}

}  // namespace
}  // namespace candela
