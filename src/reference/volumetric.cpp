// The look's light of lamps in the air (scene/look.h, Volumetric), in both modes: every lamp's integral along the
// camera ray up to the first opaque or masked surface, at fog_steps points that are equi-angular about the lamp, in
// strata that share a random offset, with traced shadows.
#include <cmath>

#include "reference/equi_angular.h"
#include "reference/integrator.h"
#include "reference/visibility.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_dimension = 1u << 23;
// Behind this optical depth e^-40 (4e-18) of the light is left.
constexpr double deepest = 40;
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
  uint32_t number = 0, place = 0;
  for (const PunctualLight& light : world_.punctual_lights()) {
    double offset = first_offset + 0.6180339887498949 * number++;
    offset -= std::floor(offset);
    if (light.type == LightType::directional) continue;
    EquiAngular angles(origin, direction, light.position);
    const Span near = angles.within(light.range_m);
    Span span{std::max(near.begin_m, 0.0), std::min(near.end_m, end_m)};
    if (tau > 0) span.end_m = std::min(span.end_m, deepest / tau);
    if (span.empty()) continue;
    angles.limit(span);
    for (int j = 0; j < steps; ++j) {
      const double at = angles.distance_at((j + (j % 2 == 0 ? offset : 1 - offset)) / steps);
      const double density = angles.density(at) * steps;
      if (!std::isfinite(at) || !(density > 0)) continue;
      const glm::dvec3 position = origin + direction * at;
      const Arrival a = arriving(light, position, own_place(on_disc, place++));
      if (a.illuminance == glm::dvec3(0)) continue;
      const double share = glm::distance(position, light.position) / light.range_m,
                   fourth = share * share * share * share;
      const double scattered = look.by_attenuation ? std::max(1 - fourth, 0.0) : tau;
      const double factor = look.phi * scattered * henyey_greenstein(glm::dot(a.l, direction), look.anisotropy) *
                            std::exp(-tau * (at + a.distance_m)) / density;
      if (!(factor > 0)) continue;
      sum += a.illuminance * factor *
             (settings_.visibility ? transmittance(world_, {position, {}, 0}, a.l, a.distance_m, nullptr, true) : 1.0);
    }
  }
  return sum;
}

void Integrator::add_volumetric(const CameraRay& camera, SampleStream& stream, PixelSample& out,
                                TermSample* terms) const {
  const glm::dvec3 onward = glm::normalize(camera.direction);
  std::optional<Hit> hit = next_surface(world_, rounded(camera), true, nullptr, nullptr);
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
