// The look's light of lamps in the air (look/look.h, Volumetric), in both modes: every lamp's integral along the
// camera ray up to the first opaque or masked surface, at fog_steps points that are equi-angular about the lamp, in
// strata that share a random offset, with traced shadows. Where more than fog_lights lamps reach the ray, all share the
// points of so many (lamps_along_ray.h).
#include <cmath>

#include "reference/equi_angular.h"
#include "reference/integrator.h"
#include "reference/lamps_along_ray.h"
#include "reference/visibility.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_dimension = 1u << 23;
// Path has no number of points; one sample's are few, and its samples are many.
constexpr int steps_of_path = 4;

}  // namespace

glm::dvec3 Integrator::volumetric_light(glm::dvec3 origin, glm::dvec3 direction, double end_m,
                                        SampleStream& stream) const {
  const Volumetric& look = *world_.volumetric();
  const double tau = look.tau_per_m;
  const int steps = settings_.fog_steps > 0 ? settings_.fog_steps : steps_of_path;
  stream.start(first_dimension);
  const double first_offset = stream.next();
  const glm::dvec2 on_disc = stream.next2();
  glm::dvec3 sum(0);
  uint32_t place = 0;
  const Span all{0, tau > 0 ? std::min(end_m, deepest / tau) : end_m};
  if (all.empty()) return sum;
  // A point of a lamp's light, of so many.
  const auto follow = [&](const PunctualLight& light, const EquiAngular& angles, double points, double u) {
    const double at = angles.distance_at(u);
    const double density = angles.density(at) * points;
    if (!std::isfinite(at) || !(density > 0)) return;
    const glm::dvec3 position = origin + direction * at;
    const Arrival a = arriving(light, position, own_place(on_disc, place++));
    if (a.illuminance == glm::dvec3(0)) return;
    const double fraction = glm::distance(position, light.position) / light.range_m,
                 fourth = fraction * fraction * fraction * fraction;
    const double scattered = look.by_attenuation ? std::max(1 - fourth, 0.0) : tau;
    const double factor = look.phi * scattered * henyey_greenstein(glm::dot(a.l, direction), look.anisotropy) *
                          std::exp(-tau * (at + a.distance_m)) / density;
    if (!(factor > 0)) return;
    sum += a.illuminance * factor *
           (settings_.visibility ? transmittance(world_, {position, {}, 0}, a.l, a.distance_m, nullptr, true) : 1.0);
  };
  const auto angles_of = [&](const PunctualLight& light) {
    EquiAngular angles(origin, direction, light.position, light.least_m);
    angles.limit(lit_part(light, origin, direction, all));
    return angles;
  };
  const LampsAlongRay lamps(world_, origin, direction, all, look.anisotropy,
                            [&](double at_m, glm::dvec3, glm::dvec3, double distance_m) {
                              return glm::dvec3(std::exp(-tau * (at_m + distance_m)));
                            });
  static thread_local std::vector<uint32_t> reaching;
  const size_t most = settings_.fog_lights > 0 ? size_t(settings_.fog_lights) : world_.punctual_lights().size();
  if (lamps.reaching(most, reaching)) {
    for (const uint32_t index : reaching) {
      const PunctualLight& light = world_.punctual_lights()[index];
      const EquiAngular angles = angles_of(light);
      double offset = first_offset + 0.6180339887498949 * index;
      offset -= std::floor(offset);
      for (int j = 0; j < steps; ++j) follow(light, angles, steps, (j + (j % 2 == 0 ? offset : 1 - offset)) / steps);
    }
    return sum;
  }
  static thread_local std::vector<LampsAlongRay::Point> chosen;
  lamps.choose(steps * settings_.fog_lights, first_offset, chosen);
  for (const LampsAlongRay::Point& p : chosen) {
    const PunctualLight& light = world_.punctual_lights()[p.light];
    follow(light, angles_of(light), p.expected, p.u);
  }
  return sum;
}

void Integrator::add_volumetric(const CameraRay& camera, const std::optional<Hit>& first, SampleStream& stream,
                                PixelSample& out, TermSample* terms) const {
  const glm::dvec3 onward = glm::normalize(camera.direction);
  std::optional<Hit> hit = first;
  while (hit && world_.is_blended(hit->item)) {
    const Hit passed = *hit;
    hit = next_surface(world_, rounded(camera), true, &passed, nullptr);
  }
  const double end_m = hit ? double(hit->t) * glm::length(camera.direction) : endless;
  const glm::dvec3 light = volumetric_light(camera.origin, onward, end_m, stream);
  out.radiance += light;
  if (terms) (*terms)[Term::volumetric] += light;
}

}  // namespace candela::reference
