#include "reference/punctual.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/sampling.h"

namespace candela::reference {

PunctualLight punctual_light(const LightItem& item, double least_m) {
  PunctualLight light;
  light.type = item.type;
  light.position = item.position;
  light.direction = glm::normalize(glm::dvec3(item.direction));
  light.intensity = item.intensity;
  light.range_m = item.range_m;
  light.cos_inner = std::cos(double(item.inner_cone_rad));
  light.cos_outer = std::cos(double(item.outer_cone_rad));
  light.radius_m = item.radius_m;
  light.radius_rad = item.radius_rad;
  light.least_m = least_m;
  return light;
}

namespace {

using std::numbers::pi;

// What a light is from a point: a cap of directions about an axis, and the illuminance that a direction of it stands
// for when they are chosen evenly.
struct Cap {
  glm::dvec3 axis{0, 1, 0};
  double centre_m = 0;     // distance of the light's centre; infinity for directional lights
  double height = 0;       // 1 - cos of its half angle: 0 a point, 2 all directions
  glm::dvec3 illuminance;  // of all of it
  double pdf() const { return height > 0 ? 1 / (2 * pi * height) : 0; }
};

// 1 - cos of an angle, which keeps its digits where the angle is small.
double height_of(double sine) { return sine * sine / (1 + std::sqrt(std::max(1 - sine * sine, 0.0))); }

Cap cap_of(const PunctualLight& light, glm::dvec3 position) {
  Cap cap;
  if (light.type == LightType::directional) {
    cap.axis = -light.direction;
    cap.illuminance = light.intensity;
    cap.centre_m = std::numeric_limits<double>::infinity();
    const double half = std::sin(light.radius_rad / 2);
    cap.height = 2 * half * half;
  } else {
    const glm::dvec3 to_light = light.position - position;
    cap.centre_m = glm::length(to_light);
    if (cap.centre_m > 0) cap.axis = to_light / cap.centre_m;
    // The window of the specification's recommendation: 1 - (d/range)^4, no square.
    const double window =
        std::isfinite(light.range_m) ? std::clamp(1 - std::pow(cap.centre_m / light.range_m, 4), 0.0, 1.0) : 1.0;
    const double held = std::max({cap.centre_m, light.least_m, light.radius_m});
    double factor = window / (held * held);
    if (light.type == LightType::spot) {
      const double scale = 1 / std::max(0.001, light.cos_inner - light.cos_outer);
      const double t = std::clamp((glm::dot(-cap.axis, light.direction) - light.cos_outer) * scale, 0.0, 1.0);
      factor *= t * t;
    }
    cap.illuminance = light.intensity * factor;
    if (light.radius_m > 0) cap.height = cap.centre_m > light.radius_m ? height_of(light.radius_m / cap.centre_m) : 2;
  }
  // Light of one radiance: over a cap the mean cosine to its middle is 1 - height / 2; from all sides a surface gets a
  // quarter of what comes.
  if (cap.height == 2)
    cap.illuminance *= 4.0;
  else if (cap.height > 0)
    cap.illuminance /= 1 - cap.height / 2;
  return cap;
}

// To the sphere's surface: the near one from outside, the only one from inside.
double surface_distance(const PunctualLight& light, const Cap& cap, double cosine, double sine2) {
  const double along = cap.centre_m * cosine;
  const double half = std::sqrt(std::max(light.radius_m * light.radius_m - cap.centre_m * cap.centre_m * sine2, 0.0));
  return std::max(cap.height == 2 ? along + half : along - half, 0.0);
}

}  // namespace

Arrival arriving(const PunctualLight& light, glm::dvec3 position, glm::dvec2 u) {
  const Cap cap = cap_of(light, position);
  Arrival a{cap.illuminance, cap.axis, cap.centre_m, cap.pdf()};
  if (!(cap.height > 0)) return a;
  const double down = u.x * cap.height, across2 = down * (2 - down), phi = 2 * pi * u.y;
  glm::dvec3 x, y;
  make_frame(cap.axis, x, y);
  a.l = glm::normalize(cap.axis * (1 - down) + std::sqrt(across2) * (std::cos(phi) * x + std::sin(phi) * y));
  if (light.radius_m > 0) a.distance_m = surface_distance(light, cap, 1 - down, across2);
  return a;
}

std::optional<Arrival> light_in(const PunctualLight& light, glm::dvec3 position, glm::dvec3 l) {
  if (!light.has_size()) return std::nullopt;
  const Cap cap = cap_of(light, position);
  // By the difference of the unit vectors: 1 - cos without its cancellation.
  const glm::dvec3 aside = l - cap.axis;
  const double down = glm::dot(aside, aside) / 2;
  if (cap.height < 2 && !(down < cap.height)) return std::nullopt;
  Arrival a{cap.illuminance, l, cap.centre_m, cap.pdf()};
  if (light.radius_m > 0) a.distance_m = surface_distance(light, cap, 1 - down, down * (2 - down));
  return a;
}

}  // namespace candela::reference
