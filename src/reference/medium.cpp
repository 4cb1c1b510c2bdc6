#include "reference/medium.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/sampling.h"

namespace candela::reference {
namespace {

// e^600 times any extinction that a float holds is still a number; what is denser lets nothing through in any case.
double held_exp(double x) { return std::exp(std::min(x, 600.0)); }

double optical_depth(double extinction, double length) {
  return extinction > 0 ? extinction * length : 0;
}  // 0 times infinity is 0

}  // namespace

double one_minus_exp_over(double x) {
  // expm1 keeps all digits of 1 - e^-x; only the quotient at 0 has no value of its own.
  return x > 0 ? (std::isinf(x) ? 0 : -std::expm1(-x) / x) : 1;
}

Medium::Medium(const Fog& fog, glm::dvec3 eye_world)
    : extinction_(fog.extinction_per_m),
      scattering_(fog.scattering_per_m),
      anisotropy_(fog.anisotropy),
      falloff_(fog.falloff_per_m),
      height_(fog.height_m - eye_world.y),
      lowest_(fog.lowest - eye_world),
      highest_(fog.highest - eye_world) {
  for (int c = 0; c < 3; ++c)
    if (fog.emission_per_m[c] > 0) glow_[c] = fog.emission_per_m[c] / fog.extinction_per_m[c];
  if (fog.turn_rad == 0) return;
  turn_ = {std::cos(fog.turn_rad), std::sin(fog.turn_rad)};
  middle_ = {0.5 * (lowest_.x + highest_.x), 0.5 * (lowest_.z + highest_.z)};
}

Span Medium::inside(glm::dvec3 origin, glm::dvec3 direction, Span of) const {
  if (turn_.y != 0 || turn_.x != 1) {
    const auto unturned = [&](glm::dvec3 v) {
      return glm::dvec3(turn_.x * v.x - turn_.y * v.z, v.y, turn_.y * v.x + turn_.x * v.z);
    };
    const glm::dvec3 middle(middle_.x, 0, middle_.y);
    origin = unturned(origin - middle) + middle;
    direction = unturned(direction);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double low = lowest_[axis] - origin[axis], high = highest_[axis] - origin[axis];
    if (direction[axis] == 0) {
      if (low > 0 || high < 0) return {of.begin_m, of.begin_m};
      continue;
    }
    const double a = low / direction[axis], b = high / direction[axis];
    of.begin_m = std::max(of.begin_m, std::min(a, b));
    of.end_m = std::min(of.end_m, std::max(a, b));
  }
  return of;
}

double Medium::density(glm::dvec3 position) const { return falloff_ > 0 ? held_exp(log_density(position.y)) : 1; }

double Medium::length(glm::dvec3 origin, glm::dvec3 direction, Span of) const {
  if (of.empty()) return 0;
  const double metres = of.end_m - of.begin_m, rate = falloff_ * direction.y;
  if (falloff_ == 0) return metres;
  const double first = log_density(origin.y + direction.y * of.begin_m);
  if (rate == 0) {
    const double level = held_exp(first);
    return level > 0 ? level * metres : 0;
  }
  if (std::isinf(metres)) return rate > 0 ? held_exp(first) / rate : endless;
  // From the lower end up, where the density only falls: nothing overflows that does not have to.
  const double lower = rate > 0 ? first : log_density(origin.y + direction.y * of.end_m);
  return held_exp(lower) * metres * one_minus_exp_over(std::abs(rate) * metres);
}

double Medium::distance_at(glm::dvec3 origin, glm::dvec3 direction, double begin_m, double length) const {
  if (!(length > 0)) return begin_m;
  const double rate = falloff_ * direction.y;
  if (falloff_ == 0) return begin_m + length;
  const double first = log_density(origin.y + direction.y * begin_m);
  // Logarithms: the density may be no number where the distance is one.
  const double as_level = std::log(length) - first;  // of the distance at the density where it begins
  if (rate == 0) return begin_m + std::exp(as_level);
  const double ratio = std::log(std::abs(rate)) + as_level;
  if (ratio < -40) return begin_m + std::exp(as_level);  // the density does not change on the way
  if (rate < 0)
    return begin_m + (ratio > 0 ? ratio + std::log1p(std::exp(-ratio)) : std::log1p(std::exp(ratio))) / -rate;
  if (ratio >= 0) return endless;
  // ln(1 - e^ratio), from the side where no digits cancel.
  return begin_m - (ratio < -std::numbers::ln2 ? std::log1p(-std::exp(ratio)) : std::log(-std::expm1(ratio))) / rate;
}

glm::dvec3 Medium::through(double length) const {
  glm::dvec3 out;
  for (int c = 0; c < 3; ++c) out[c] = std::exp(-optical_depth(extinction_[c], length));
  return out;
}

glm::dvec3 Medium::held(double length) const {
  glm::dvec3 out;
  for (int c = 0; c < 3; ++c) out[c] = -std::expm1(-optical_depth(extinction_[c], length));
  return out;
}

glm::dvec3 Medium::transmittance(glm::dvec3 origin, glm::dvec3 direction, double distance_m) const {
  return through(length(origin, direction, inside(origin, direction, {0, distance_m})));
}

double henyey_greenstein(double cosine, double g) {
  // (1 - g)^2 + 2 g (1 - cosine) is 1 + g^2 - 2 g cosine without its cancellation; from the side where the terms have
  // one sign.
  const double base = g < 0 ? (1 + g) * (1 + g) - 2 * g * (1 + cosine) : (1 - g) * (1 - g) + 2 * g * (1 - cosine);
  return (1 - g * g) / (4 * std::numbers::pi * base * std::sqrt(base));
}

glm::dvec3 sample_henyey_greenstein(glm::dvec3 onward, double g, glm::dvec2 u) {
  // The usual inverse, (1 + g^2 - ((1 - g^2)/(1 + g s))^2) / 2g, with the quotient by g worked out.
  const double s = 2 * u.x - 1, d = 1 + g * s;
  const double cosine =
      std::clamp((s + g * (s * s + 3) / 2 + g * g * s + g * g * g * (s * s - 1) / 2) / (d * d), -1.0, 1.0);
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0)), longitude = 2 * std::numbers::pi * u.y;
  glm::dvec3 x, y;
  make_frame(onward, x, y);
  return glm::normalize(sine * (std::cos(longitude) * x + std::sin(longitude) * y) + cosine * onward);
}

}  // namespace candela::reference
