#pragma once
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "reference/medium.h"
#include "reference/punctual.h"

namespace candela::reference {

// Points of a ray as a light beside it sees them: all angles alike, which is the inverse square of the distance (Kulla
// and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012).
class EquiAngular {
 public:
  // least_m: beside the light the inverse square is held so near, and so is this.
  EquiAngular(glm::dvec3 origin, glm::dvec3 direction, glm::dvec3 light, double least_m = 0.01) : least_m_(least_m) {
    const glm::dvec3 to_light = light - origin;
    nearest_m_ = glm::dot(to_light, direction);
    aside_m_ = glm::length(to_light - nearest_m_ * direction);
  }
  // The part of the ray within a distance of the light.
  Span within(double range_m) const {
    if (!(range_m > aside_m_)) return {0, 0};
    const double half = std::isinf(range_m) ? endless : std::sqrt(range_m - aside_m_) * std::sqrt(range_m + aside_m_);
    return {nearest_m_ - half, nearest_m_ + half};
  }
  void limit(Span span) {
    h_ = std::max(aside_m_, least_m_);
    from_ = span.begin_m - nearest_m_, to_ = span.end_m - nearest_m_;
    // The difference of two arc tangents, as the angle between the two directions: no cancellation where the light is
    // far.
    angle_ = std::isinf(to_) ? std::atan2(h_, from_) : std::atan2(h_ * (to_ - from_), h_ * h_ + from_ * to_);
  }
  double angle() const { return angle_; }
  double aside_m() const { return h_; }
  double distance_at(double u) const {
    const double t = std::tan(u * angle_), below = h_ - from_ * t;
    const double s = below > 0 || u * angle_ > std::numbers::pi / 2 ? h_ * (from_ + h_ * t) / below : endless;
    return nearest_m_ + std::clamp(s, from_, to_);
  }
  double density(double distance_m) const {  // per metre of the ray
    const double s = distance_m - nearest_m_;
    return h_ / (angle_ * (h_ * h_ + s * s));
  }

 private:
  double least_m_ = 0.01, nearest_m_, aside_m_, h_ = 1, from_ = 0, to_ = 0, angle_ = 0;
};

}  // namespace candela::reference
