#pragma once
#include <array>
#include <glm/glm.hpp>
#include <limits>

namespace candela {

// Axis-aligned box. Empty when min > max; union with an empty box is the other box.
template <class V>
struct Box {
  V min = V(std::numeric_limits<typename V::value_type>::infinity());
  V max = V(-std::numeric_limits<typename V::value_type>::infinity());
  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  void add(const V& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void add(const Box& b) {
    if (!b.empty()) min = glm::min(min, b.min), max = glm::max(max, b.max);
  }
  V centre() const { return (min + max) * typename V::value_type(0.5); }
  V extent() const { return (max - min) * typename V::value_type(0.5); }  // half sizes
};
using Aabb = Box<glm::vec3>;
using DAabb = Box<glm::dvec3>;

// Box of a transformed box (Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems, 1990).
inline DAabb transformed(const DAabb& box, const glm::dmat4& m) {
  if (box.empty()) return box;
  const glm::dvec3 c = glm::dvec3(m * glm::dvec4(box.centre(), 1.0)), e = box.extent();
  glm::dvec3 r(0);
  for (int i = 0; i < 3; ++i) r += glm::abs(glm::dvec3(m[i])) * e[i];
  return {c - r, c + r};
}

// Planes (n, w) with n of unit length, inside where dot(n, p) + w >= 0: left, right, bottom, top, near. An infinite
// projection has no far plane (extracting one gives 0/0).
using FrustumPlanes = std::array<glm::dvec4, 5>;
// From clip_from_X, reversed depth: near is w - z >= 0. Gribb and Hartmann 2001, rows of the matrix.
inline FrustumPlanes frustum_planes(const glm::dmat4& clip_from_space) {
  const glm::dmat4 t = glm::transpose(clip_from_space);
  FrustumPlanes planes = {t[3] + t[0], t[3] - t[0], t[3] + t[1], t[3] - t[1], t[3] - t[2]};
  for (glm::dvec4& p : planes) p /= glm::length(glm::dvec3(p));
  return planes;
}

}  // namespace candela
