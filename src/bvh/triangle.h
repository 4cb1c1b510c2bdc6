#pragma once
#include <cmath>
#include <glm/glm.hpp>

#include "bvh/ray.h"

namespace candela {

// Watertight ray and triangle test (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", 2013): corners are
// sheared so that the ray runs along one axis; what is left is a 2D test whose edge functions have the exact sign, or
// are zero and then made anew in double, where products of floats are exact. Needs arithmetic without fused
// multiply-add, or both sides of a shared edge would round differently. The wide kernels do the same operations in the
// same order.
struct RayShear {
  int x = 0, y = 1, z = 2;  // the axis of the largest direction component is z
  float sx = 0, sy = 0, sz = 1;
};

inline RayShear shear_of(glm::vec3 direction) {
  const glm::vec3 size = glm::abs(direction);
  RayShear s;
  s.z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  s.x = s.z == 2 ? 0 : s.z + 1;
  s.y = s.x == 2 ? 0 : s.x + 1;
  if (direction[s.z] < 0) std::swap(s.x, s.y);  // keeps the winding
  s.sz = 1.0f / direction[s.z];
  s.sx = direction[s.x] * s.sz;
  s.sy = direction[s.y] * s.sz;
  return s;
}

// Directions are used as they come, of any length, but t then grows and shrinks with it, and may leave the range of
// floats on the way. The power of two by which a ray's direction is to be divided, and t multiplied, to keep away from
// the ends; 1 for all directions of usual lengths.
constexpr float usual_direction_min = 0x1p-20f, usual_direction_max = 0x1p20f;
inline float direction_scale(glm::vec3 direction) {
  const glm::vec3 size = glm::abs(direction);
  const float largest = size.x > size.y ? (size.x > size.z ? size.x : size.z) : (size.y > size.z ? size.y : size.z);
  if (largest >= usual_direction_min && largest <= usual_direction_max) return 1;
  return std::ldexp(1.0f, std::ilogb(largest));
}

struct TriangleHit {
  float t, u, v;
  bool clockwise;  // as seen along the ray: the corners' normal by the right-hand rule points along it
};

// The edge functions of the sheared corners and the hit from them, in double. Float corners times float corners are
// exact.
inline bool meet_sheared_double(const float (&a)[3], const float (&b)[3], const float (&c)[3], float t_min, float t_max,
                                TriangleHit& hit) {
  const double u = double(c[0]) * double(b[1]) - double(c[1]) * double(b[0]);
  const double v = double(a[0]) * double(c[1]) - double(a[1]) * double(c[0]);
  const double w = double(b[0]) * double(a[1]) - double(b[1]) * double(a[0]);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double determinant = u + v + w;
  if (!(determinant != 0)) return false;  // seen edge-on, or NaN
  const double t = (u * double(a[2]) + v * double(b[2]) + w * double(c[2])) / determinant;
  const float rounded = float(t);
  if (!(rounded >= t_min && rounded <= t_max)) return false;
  hit = {rounded, float(v / determinant), float(w / determinant), determinant < 0};
  return true;
}

// Edge functions whose sum lies outside these limits may have lost digits to underflow or overflow in float.
constexpr float smallest_float_determinant = 1e-20f, largest_float_determinant = 1e30f;

// t_min <= t <= t_max. Degenerate triangles and those seen edge-on are not hit.
inline bool meet_triangle(const RayShear& s, glm::vec3 origin, glm::vec3 p0, glm::vec3 p1, glm::vec3 p2, float t_min,
                          float t_max, TriangleHit& hit) {
  const auto sheared = [&](glm::vec3 p, float(&out)[3]) {
    const float z = p[s.z] - origin[s.z];
    out[0] = (p[s.x] - origin[s.x]) - s.sx * z;
    out[1] = (p[s.y] - origin[s.y]) - s.sy * z;
    out[2] = s.sz * z;
  };
  float a[3], b[3], c[3];
  sheared(p0, a), sheared(p1, b), sheared(p2, c);
  const float u = c[0] * b[1] - c[1] * b[0];
  const float v = a[0] * c[1] - a[1] * c[0];
  const float w = b[0] * a[1] - b[1] * a[0];
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const float determinant = (u + v) + w;
  const float size = std::abs(determinant);
  if (u == 0 || v == 0 || w == 0 || !(size >= smallest_float_determinant && size <= largest_float_determinant))
    return meet_sheared_double(a, b, c, t_min, t_max, hit);
  const float t = ((u * a[2] + v * b[2]) + w * c[2]) / determinant;
  if (!(t >= t_min && t <= t_max)) return false;
  hit = {t, v / determinant, w / determinant, determinant < 0};
  return true;
}

}  // namespace candela
