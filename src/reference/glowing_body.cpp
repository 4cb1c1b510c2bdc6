#include "reference/glowing_body.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/metaballs.h"
#include "reference/sampling.h"

namespace candela::reference {
namespace {

// Of a sphere's cone: 1 - cos of its half angle; 2 from inside.
double cone_height(glm::dvec3 from, glm::dvec4 sphere) {
  const glm::dvec3 to = glm::dvec3(sphere) - from;
  const double sin2 = sphere.w * sphere.w / glm::dot(to, to);
  return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 2;
}

bool meets(glm::dvec3 from, glm::dvec3 direction, glm::dvec4 sphere) {
  const glm::dvec3 to = glm::dvec3(sphere) - from;
  const double along = glm::dot(to, direction), r2 = sphere.w * sphere.w;
  if (glm::dot(to, to) <= r2) return true;
  const glm::dvec3 off = to - along * direction;
  return along > 0 && glm::dot(off, off) <= r2;
}

}  // namespace

GlowingBody::GlowingBody(uint32_t item, const MetaballSurface& surface, bool two_sided)
    : item_(item), surface_(&surface), two_sided_(two_sided), spheres_(surface.spheres()) {}

std::optional<GlowingBody::Met> GlowingBody::first(glm::dvec3 from, glm::dvec3 direction) const {
  // As far as rays leave a surface before they are traced, and as roundings of such points reach.
  const double least_m = 64 * std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)}) * 0x1p-24;
  std::optional<Met> met;
  surface_->each_crossing(from, direction, [&](double t, bool goes_in) {
    if (t < least_m) return false;
    met = Met{direction, t, !goes_in};
    return true;
  });
  return met;
}

std::optional<GlowingBody::Met> GlowingBody::sample(glm::dvec3 from, glm::dvec2 u) const {
  double total = 0;
  for (const glm::dvec4& sphere : spheres_) total += cone_height(from, sphere);
  if (!(total > 0)) return std::nullopt;
  double at = u.x * total;
  for (size_t i = 0; i < spheres_.size(); ++i) {
    const double height = cone_height(from, spheres_[i]);
    if (at >= height && i + 1 < spheres_.size()) {
      at -= height;
      continue;
    }
    const double down = std::min(at, height), across = std::sqrt(std::max(down * (2 - down), 0.0));
    const double turn = 2 * std::numbers::pi * u.y;
    const glm::dvec3 to = glm::dvec3(spheres_[i]) - from;
    const double length = glm::length(to);
    const glm::dvec3 z = length > 0 ? to / length : glm::dvec3(0, 0, 1);
    glm::dvec3 x, y;
    make_frame(z, x, y);
    return first(from, glm::normalize(across * (std::cos(turn) * x + std::sin(turn) * y) + (1 - down) * z));
  }
  return std::nullopt;
}

double GlowingBody::density(glm::dvec3 from, glm::dvec3 direction) const {
  double total = 0;
  size_t held = 0;
  for (const glm::dvec4& sphere : spheres_) {
    total += cone_height(from, sphere);
    held += meets(from, direction, sphere);
  }
  return total > 0 ? double(held) / (2 * std::numbers::pi * total) : 0;
}

}  // namespace candela::reference
