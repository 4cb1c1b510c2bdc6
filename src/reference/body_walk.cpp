// A path in a body that scatters light: a random walk from event to event (KHR_materials_volume_scatter). The way to
// the next event follows the transmittance of one channel, each as likely as it has throughput, and is weighted by the
// mean density of all (spectral multiple importance sampling: Wilkie et al., "Hero Wavelength Spectral Sampling",
// 2014). The medium is even, so nothing is stepped. At each event lights are met as in fog: those that shine straight
// through the body's walls or stand within it, and lamps whose light smooth walls bend; all other light meets the walk
// at the walls.
#include <algorithm>
#include <cmath>

#include "reference/integrator.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_event_dimension = 1u << 26, event_dimensions = 16;
constexpr uint32_t first_bent_dimension = 1u << 27, bent_dimensions = 1u << 14;
constexpr double off_walls = 4e-6;  // of the place's coordinates: rays begin at floats, and must begin within the body

double largest_coordinate(glm::dvec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

}  // namespace

Integrator::BodyStep Integrator::body_step(const GlassWay& way, glm::dvec3 origin, glm::dvec3 direction, double end_m,
                                           glm::dvec3 through, double compressed, int bounce, uint32_t number,
                                           SampleStream& stream, glm::dvec3 sky) const {
  const BodyMedium& medium = *way.here().medium();
  BodyStep step;
  const double begin_m = way.travelled_m(), length_m = std::max(end_m - begin_m, 0.0);
  const double all = through.x + through.y + through.z;
  if (!(all > 0)) return step;
  stream.start(first_event_dimension + number * event_dimensions);
  const double decision = stream.next(), channel = stream.next(), place = stream.next(), roulette = stream.next();
  const glm::dvec2 for_direction = stream.next2();
  const double which = stream.next();

  const glm::dvec3 likely = through / all;
  glm::dvec3 scatters(0), passes(1);
  for (int c = 0; c < 3; ++c)
    if (medium.scattering[c] > 0) {
      scatters[c] = -std::expm1(-medium.extinction[c] * length_m);
      passes[c] = std::exp(-medium.extinction[c] * length_m);
    }
  int chosen = 0;
  double left = channel;
  while (chosen < 2 && left >= likely[chosen]) left -= likely[chosen++];
  if (decision >= scatters[chosen]) {
    step.weight = glm::dvec3(1 / glm::dot(likely, passes));
    return step;
  }

  const double flown_m = std::min(-std::log1p(-place * scatters[chosen]) / medium.extinction[chosen], length_m);
  glm::dvec3 here;
  double density = 0;  // per metre
  for (int c = 0; c < 3; ++c) {
    here[c] = std::exp(-medium.extinction[c] * flown_m);
    if (medium.scattering[c] > 0) density += likely[c] * medium.extinction[c] * here[c];
  }
  step.scattered = true;
  step.weight = medium.scattering * here / density;
  // Nearer to the wall than floats tell is as near as they tell.
  const double last_m = end_m - off_walls * largest_coordinate(origin + direction * end_m);
  step.position = origin + direction * std::clamp(begin_m + flown_m, begin_m, std::max(last_m, begin_m));

  // Light is met before the path may end here.
  const double g = medium.anisotropy;
  const bool every = bounce == 0;
  step.light = through * step.weight * fog_event(step.position, direction, g, every, which, stream, sky, &way.here());
  if (world_.bends_lamps()) {
    SampleStream apart = stream;
    apart.start(first_bent_dimension + number * bent_dimensions);
    const Receiver event{
        step.position, {step.position, {}, 0},
        &way.here(),   &way.here(),
        direction,     [&](glm::dvec3 l) { return glm::dvec3(henyey_greenstein(glm::dot(l, direction), g)); }};
    step.light += through * step.weight * by_bodies(event, bounce, apart);
  }
  step.direction = sample_henyey_greenstein(direction, g, for_direction);
  step.density = henyey_greenstein(glm::dot(step.direction, direction), g);
  // A path that has lost little goes on for certain: walks are long, and every choice to go on adds to what it weighs.
  const double survive = std::min(largest(through * step.weight) / compressed, 1.0);
  step.weight = roulette < survive ? step.weight / survive : glm::dvec3(0);
  return step;
}

}  // namespace candela::reference
