// Fog in full transport. A path flies freely for a length of medium that is drawn from the transmittance itself, in
// closed form; where extinction differs between colours, one channel draws, each as likely as it has throughput, and
// the result is weighted by the mean density of all (spectral multiple importance sampling). Absorption weakens the
// path and never ends it. Half of the places where it scatters lie equi-angular about the point lights and spots that
// light the ray most; the rest follows transmittance. On the camera's ray one path in four at least scatters where
// there is any fog.
#include <algorithm>
#include <array>
#include <cmath>

#include "reference/equi_angular.h"
#include "reference/glass_light.h"
#include "reference/integrator.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_fog_dimension = 1u << 22, dimensions_a_step = 16;
constexpr double least_scattering = 0.25;
// The strongest lights along the ray, of so many: any choice of them is right, but each costs.
constexpr size_t most_lights_in_view = 16, most_lights = 4096;

// Places on a ray in view of its lights, each light as likely as its unhindered light along the ray is strong.
class InViewOfLights {
 public:
  InViewOfLights(const World& world, glm::dvec3 origin, glm::dvec3 direction, Span span) {
    if (world.tree_punctual().size() > most_lights) return;
    for (const uint32_t index : world.tree_punctual()) {
      const PunctualLight& light = world.punctual_lights()[index];
      EquiAngular angles(origin, direction, light.position);
      const Span near = angles.within(light.range_m);
      const Span seen{std::max(near.begin_m, span.begin_m), std::min(near.end_m, span.end_m)};
      if (seen.empty()) continue;
      angles.limit(seen);
      const double weight = luminance(light.intensity) * angles.angle() / angles.aside_m();
      if (!(weight > 0)) continue;
      if (count_ < most_lights_in_view) {
        lights_[count_++] = {angles, seen, weight};
      } else if (Seen& weakest = *std::ranges::min_element(lights_, {}, &Seen::weight); weight > weakest.weight) {
        weakest = {angles, seen, weight};
      }
    }
    for (size_t i = 0; i < count_; ++i) sum_ += lights_[i].weight;
  }
  bool empty() const { return count_ == 0 || !std::isfinite(sum_); }
  double distance_at(double u) const {
    double left = u * sum_;
    size_t i = 0;
    for (; i + 1 < count_ && left >= lights_[i].weight; ++i) left -= lights_[i].weight;
    return lights_[i].angles.distance_at(std::clamp(left / lights_[i].weight, 0.0, 1.0));
  }
  double density(double distance_m) const {
    double density = 0;
    for (size_t i = 0; i < count_; ++i)
      if (const Seen& l = lights_[i]; distance_m >= l.span.begin_m && distance_m <= l.span.end_m)
        density += l.weight / sum_ * l.angles.density(distance_m);
    return density;
  }

 private:
  struct Seen {
    EquiAngular angles{glm::dvec3(0), glm::dvec3(0, 0, 1), glm::dvec3(0)};
    Span span;
    double weight = 0;
  };
  std::array<Seen, most_lights_in_view> lights_;
  size_t count_ = 0;
  double sum_ = 0;
};

}  // namespace

Integrator::FogStep Integrator::fog_step(glm::dvec3 origin, glm::dvec3 direction, double end_m, glm::dvec3 through,
                                         int bounce, uint32_t number, bool every, SampleStream& stream,
                                         PixelSample& out) const {
  const Medium& medium = *world_.medium();
  const Span span = medium.inside(origin, direction, {0, end_m});
  const double length = medium.length(origin, direction, span);
  const glm::dvec3 clear = medium.through(length), held = medium.held(length);
  const glm::dvec3 emitted = through * medium.glow() * held;
  out.radiance += emitted;
  if (bounce == 0) out.fog_light += emitted;
  FogStep step;
  step.through = through * clear, step.clear = clear;
  const double all = through.x + through.y + through.z;
  const bool may_scatter = !(settings_.most_bounces > 0 && bounce >= settings_.most_bounces);
  if (!may_scatter || !medium.scatters() || !(length > 0) || !(all > 0)) return step;

  stream.start(first_fog_dimension + number * dimensions_a_step);
  const double decision = stream.next(), place = stream.next(), channel = stream.next(), way = stream.next();
  const glm::dvec3 likely = through / all;
  glm::dvec3 scatters(0), passes(1);  // how likely either is, as each channel would have it
  for (int c = 0; c < 3; ++c) {
    if (!(medium.scattering()[c] > 0) || !(held[c] > 0)) continue;
    const bool forced = bounce == 0 && held[c] < least_scattering;
    scatters[c] = forced ? least_scattering : held[c];
    passes[c] = forced ? 1 - least_scattering : clear[c];
  }
  int chosen = 0;
  double left = channel;
  while (chosen < 2 && left >= likely[chosen]) left -= likely[chosen++];
  if (decision >= scatters[chosen]) {
    step.through /= glm::dot(likely, passes);
    return step;
  }

  const InViewOfLights lights(world_, origin, direction, span);
  const double by_angle = lights.empty() ? 0 : 0.5;
  const double sigma = medium.extinction()[chosen];
  double travelled = 0, distance_m = 0;
  if (way < by_angle) {
    distance_m = lights.distance_at(place);
    travelled = medium.length(origin, direction, {span.begin_m, distance_m});
  } else {
    travelled = std::min(-std::log1p(-place * held[chosen]) / sigma, length);
    distance_m = std::min(medium.distance_at(origin, direction, span.begin_m, travelled), span.end_m);
  }
  step.scattered = true;
  step.through = glm::dvec3(0);
  step.position = origin + direction * distance_m;
  if (!std::isfinite(distance_m)) return step;
  const glm::dvec3 here = medium.through(travelled);
  double density = 0;  // per metre of medium
  for (int c = 0; c < 3; ++c)
    if (scatters[c] > 0)
      density += (1 - by_angle) * likely[c] * scatters[c] * medium.extinction()[c] * here[c] / held[c];
  if (by_angle > 0)
    density += by_angle * glm::dot(likely, scatters) * lights.density(distance_m) / medium.density(step.position);
  if (!(density > 0)) return step;
  step.through = through * medium.scattering() * here / density;

  const glm::dvec2 for_direction = stream.next2();
  const double roulette = stream.next(), which = stream.next();
  out.radiance += step.through * fog_event(step.position, direction, every, which, stream);
  step.direction = sample_henyey_greenstein(direction, medium.anisotropy(), for_direction);
  step.density = henyey_greenstein(glm::dot(step.direction, direction), medium.anisotropy());
  if (!survives(roulette, bounce + 1, step.through)) step.through = glm::dvec3(0);
  return step;
}

// Light that comes straight from its source to a place in fog and is scattered into the direction of travel towards it,
// turned around: every directional light, one direction of the sky, and lights of the tree.
glm::dvec3 Integrator::fog_event(glm::dvec3 position, glm::dvec3 direction, bool every, double which,
                                 SampleStream& stream) const {
  const double g = world_.medium()->anisotropy();
  const SurfacePoint point{position, {}, 0};
  const auto phase = [&](glm::dvec3 l) { return henyey_greenstein(glm::dot(l, direction), g); };
  const auto arrives = [&](const Offer& offer) {
    const glm::dvec3 light = offer.radiance * world_.through_fog(position, offer.l, offer.distance_m);
    if (light == glm::dvec3(0)) return light;
    return light * light_through(world_, point, offer.l, offer.distance_m, nullptr, offer.end ? &*offer.end : nullptr,
                                 offer.is_lamp());
  };
  const glm::dvec2 for_sky = stream.next2(), on_light = stream.next2();
  double pick = stream.next();
  const glm::dvec2 on_disc = stream.next2();
  const auto punctual_offer_of = [&](const PunctualLight& light, size_t number, double probability) -> Offer {
    const Arrival a = arriving(light, position, own_place(on_disc, number));
    const double p = phase(a.l);
    // A light of a size is met by the phase function's direction as well.
    const double w = a.pdf > 0 ? weight(probability * a.pdf, p, Strategy::light) : 1;
    return {a.illuminance * (p * w), a.l, a.distance_m, {}};
  };
  glm::dvec3 sum(0);
  for (const uint32_t index : world_.directional())
    sum += arrives(punctual_offer_of(world_.punctual_lights()[index], index, 1));
  if (world_.sky() && settings_.strategy != Strategy::brdf)
    if (const Sky::Choice choice = world_.sky().sample(for_sky); choice.pdf > 0) {
      const double p = phase(choice.direction);
      const double share = p * weight(choice.pdf, p, Strategy::light) / choice.pdf;
      sum += arrives({world_.sky().radiance(choice.direction) * share, choice.direction, endless, {}});
    }
  static thread_local std::vector<LightTree::Choice> chosen;
  world_.light_tree().choose(position, glm::dvec3(0), which, true, chosen);
  const size_t points = world_.tree_punctual().size();
  OneOf best;
  for (size_t i = 0; i < chosen.size(); ++i) {
    const LightTree::Choice& choice = chosen[i];
    Offer offer;
    if (choice.light < points) {
      offer = punctual_offer_of(world_.punctual_lights()[world_.tree_punctual()[choice.light]], i, choice.probability);
      offer.radiance /= choice.probability;
    } else if (settings_.strategy != Strategy::brdf) {
      const auto p =
          emissive_point(uint32_t(choice.light - points), choice.probability, position, own_place(on_light, i));
      if (!p) continue;
      const double f = phase(p->l);
      offer = {radiance_of(*p) * (f * weight(p->pdf, f, Strategy::light) / p->pdf), p->l, p->distance_m,
               surface_of(*p)};
    }
    if (every)
      sum += arrives(offer);
    else
      best.consider(offer, largest(offer.radiance), pick);
  }
  if (!every) sum += arrives(best.offer) * best.scale();
  return sum;
}

}  // namespace candela::reference
