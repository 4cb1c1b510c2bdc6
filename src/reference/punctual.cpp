#include "reference/punctual.h"

#include <cmath>
#include <limits>

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

Arrival arriving(const PunctualLight& light, glm::dvec3 position) {
  Arrival a;
  if (light.type == LightType::directional) {
    a.l = -light.direction;
    a.illuminance = light.intensity;
    a.distance_m = std::numeric_limits<double>::infinity();
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
