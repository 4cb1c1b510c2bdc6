#include "reference/punctual.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/sampling.h"

namespace candela::reference {

PunctualLight punctual_light(const LightItem& item) {
  PunctualLight light;
  light.type = item.type;
  light.position = item.position;
  light.direction = glm::normalize(glm::dvec3(item.direction));
  light.intensity = item.intensity;
  light.range_m = item.range_m;
  light.cos_inner = std::cos(double(item.inner_cone_rad));
  light.cos_outer = std::cos(double(item.outer_cone_rad));
  return light;
}

Arrival arriving(const PunctualLight& light, glm::dvec3 position, glm::dvec2 u) {
  Arrival a;
  if (light.type == LightType::directional) {
    a.l = -light.direction;
    a.illuminance = light.intensity;
    a.distance_m = std::numeric_limits<double>::infinity();
    if (light.radius_rad > 0) {
      // 1 - cos, which keeps its digits where the disc is small.
      const double half = std::sin(light.radius_rad / 2), cap = 2 * half * half, down = u.x * cap;
      const double across = std::sqrt(down * (2 - down)), phi = 2 * std::numbers::pi * u.y;
      glm::dvec3 x, y;
      make_frame(a.l, x, y);
      a.l = glm::normalize(a.l * (1 - down) + across * (std::cos(phi) * x + std::sin(phi) * y));
      // Over the cap the mean cosine to its middle is 1 - cap / 2.
      a.illuminance /= 1 - cap / 2;
    }
    return a;
  }
  const glm::dvec3 to_light = light.position - position;
  a.distance_m = glm::length(to_light);
  if (a.distance_m > 0) a.l = to_light / a.distance_m;
  // The window of the specification's recommendation: 1 - (d/range)^4, no square.
  const double window =
      std::isfinite(light.range_m) ? std::clamp(1 - std::pow(a.distance_m / light.range_m, 4), 0.0, 1.0) : 1.0;
  const double held = std::max(a.distance_m, least_light_distance_m);
  double factor = window / (held * held);
  if (light.type == LightType::spot) {
    const double scale = 1 / std::max(0.001, light.cos_inner - light.cos_outer);
    const double t = std::clamp((glm::dot(-a.l, light.direction) - light.cos_outer) * scale, 0.0, 1.0);
    factor *= t * t;
  }
  a.illuminance = light.intensity * factor;
  return a;
}

}  // namespace candela::reference
