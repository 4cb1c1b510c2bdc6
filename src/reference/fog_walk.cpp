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
#include "reference/lamps_along_ray.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_walk_dimension = 1u << 22, walk_step_dimensions = 16;
constexpr double least_scattering = 0.25;
// Of the lamps along the ray so many, the strongest: any choice of them is right, but each costs.
constexpr size_t most_lights_in_view = 16;

// Places on a ray in view of its lights, each light as likely as its unhindered light along the ray is strong.
class InViewOfLights {
 public:
  InViewOfLights(const World& world, glm::dvec3 origin, glm::dvec3 direction, Span span) {
    // Clusters whose lamps, were all one at their nearest, are weaker than the weakest of those found stay closed.
    const std::vector<LightTree::Node>& nodes = world.lamp_tree().nodes();
    static thread_local std::vector<int> open;
    open.assign(nodes.empty() ? 0 : 1, 0);
    while (!open.empty()) {
      const LightTree::Node& node = nodes[size_t(open.back())];
      open.pop_back();
      if (node.left < 0) {
        consider(world.punctual_lights()[world.tree_punctual()[node.light]], origin, direction, span);
        continue;
      }
      const double left = most_of(nodes[size_t(node.left)], origin, direction, span),
                   right = most_of(nodes[size_t(node.right)], origin, direction, span);
      for (const bool second : {left >= right, left < right})  // the stronger one first: last on the stack
        if (const double most = second ? right : left; most > 0 && !(count_ == most_lights_in_view && most <= weakest_))
          open.push_back(second ? node.right : node.left);
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
  // No lamp of the node has a larger weight.
  static double most_of(const LightTree::Node& node, glm::dvec3 origin, glm::dvec3 direction, Span span) {
    const glm::dvec3 to_centre = node.centre - origin;
    const double nearest_m = glm::dot(to_centre, direction), along = std::clamp(nearest_m, span.begin_m, span.end_m);
    const double to_part = std::max(glm::length(to_centre - along * direction) - node.radius, 0.0);
    if (to_part > node.extent.range_m * (1 + 1e-9)) return 0;
    constexpr double least_m = 1e-30;
    const double to_line = glm::length(to_centre - nearest_m * direction) - node.radius;
    const double held = std::max(to_part, least_m);
    return node.extent.power / std::numbers::pi * (1 + 1e-9) *
           std::min(std::numbers::pi / std::max(to_line, least_m), (span.end_m - span.begin_m) / (held * held));
  }
  void consider(const PunctualLight& light, glm::dvec3 origin, glm::dvec3 direction, Span span) {
    const Span seen = lit_part(light, origin, direction, span);
    if (seen.empty()) return;
    EquiAngular angles(origin, direction, light.position, light.least_m);
    angles.limit(seen);
    const double weight = luminance(light.intensity) * angles.angle() / angles.aside_m();
    if (!(weight > 0) || (count_ == most_lights_in_view && weight <= weakest_)) return;
    if (count_ < most_lights_in_view)
      lights_[count_++] = {angles, seen, weight};
    else
      *std::ranges::min_element(lights_, {}, &Seen::weight) = {angles, seen, weight};
    if (count_ == most_lights_in_view) weakest_ = std::ranges::min_element(lights_, {}, &Seen::weight)->weight;
  }

  std::array<Seen, most_lights_in_view> lights_;
  size_t count_ = 0;
  double sum_ = 0, weakest_ = 0;
};

// All media on a ray's way, as one whose density differs from channel to channel. One alone has closed forms; where
// several lie, the place of an optical depth is found by halving.
class Air {
 public:
  Air(const std::vector<Medium>& media, glm::dvec3 origin, glm::dvec3 direction, double end_m)
      : media_(media), origin_(origin), direction_(direction) {
    for (const Medium& medium : media) {
      const Span one = medium.inside(origin, direction, {0, end_m});
      if (one.empty()) continue;
      span_ = span_.empty() ? one : Span{std::min(span_.begin_m, one.begin_m), std::max(span_.end_m, one.end_m)};
    }
    depth_ = depth(span_.end_m);
  }
  const Span& span() const { return span_; }
  const glm::dvec3& whole_depth() const { return depth_; }
  glm::dvec3 depth(double at_m) const {
    glm::dvec3 sum(0);
    for (const Medium& medium : media_) {
      const double metres = medium.length(origin_, direction_, medium.inside(origin_, direction_, {0, at_m}));
      for (int c = 0; c < 3; ++c)
        if (medium.extinction()[c] > 0) sum[c] += medium.extinction()[c] * metres;
    }
    return sum;
  }
  double distance_at(int channel, double depth_there) const {
    if (media_.size() == 1)
      return std::min(
          media_[0].distance_at(origin_, direction_, span_.begin_m, depth_there / media_[0].extinction()[channel]),
          span_.end_m);
    double low = span_.begin_m, high = span_.end_m;
    if (std::isinf(high)) {
      double wide = 1;
      while (wide < 1e300 && depth(low + wide)[channel] < depth_there) wide *= 2;
      high = low + wide;
    }
    for (int i = 0; i < 100 && low < high; ++i) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (depth(middle)[channel] < depth_there ? low : high) = middle;
    }
    return high;
  }
  // Per metre of the ray.
  double density(size_t which, double at_m) const {
    const glm::dvec3 position = origin_ + direction_ * at_m;
    if (media_.size() > 1) {
      const Span here = media_[which].inside(origin_, direction_, {at_m, std::nextafter(at_m, endless)});
      if (here.empty()) return 0;
    }
    return media_[which].density(position);
  }
  glm::dvec3 extinction(double at_m) const {
    glm::dvec3 sum(0);
    for (size_t i = 0; i < media_.size(); ++i) sum += media_[i].extinction() * density(i, at_m);
    return sum;
  }

 private:
  const std::vector<Medium>& media_;
  glm::dvec3 origin_, direction_, depth_{0};
  Span span_;
};

glm::dvec3 left_of(glm::dvec3 depth) { return {std::exp(-depth.x), std::exp(-depth.y), std::exp(-depth.z)}; }
glm::dvec3 held_of(glm::dvec3 depth) { return {-std::expm1(-depth.x), -std::expm1(-depth.y), -std::expm1(-depth.z)}; }

}  // namespace

Integrator::FogStep Integrator::fog_step(glm::dvec3 origin, glm::dvec3 direction, double end_m, glm::dvec3 through,
                                         int bounce, uint32_t number, bool every, SampleStream& stream,
                                         PixelSample& out, glm::dvec3 sky) const {
  const std::vector<Medium>& media = world_.media();
  const Air air(media, origin, direction, end_m);
  const Span span = air.span();
  const glm::dvec3 clear = left_of(air.whole_depth()), held = held_of(air.whole_depth());
  stream.start(first_walk_dimension + number * walk_step_dimensions);
  const double decision = stream.next(), place = stream.next(), channel = stream.next(), way = stream.next();
  const glm::dvec2 for_direction = stream.next2();
  const double roulette = stream.next(), which = stream.next();
  glm::dvec3 emitted(0);
  for (size_t i = 0; i < media.size(); ++i) emitted += through * fog_glow(i, origin, direction, {0, end_m}, place);
  out.radiance += emitted;
  if (bounce == 0) out.fog_light += emitted;
  FogStep step;
  step.through = through * clear, step.clear = clear;
  const double all = through.x + through.y + through.z;
  const bool may_scatter = !(settings_.most_bounces > 0 && bounce >= settings_.most_bounces);
  glm::dvec3 scatterers(0);
  for (const Medium& medium : media) scatterers += medium.scattering();
  if (!may_scatter || scatterers == glm::dvec3(0) || !(air.whole_depth() != glm::dvec3(0)) || !(all > 0)) return step;

  const glm::dvec3 likely = through / all;
  glm::dvec3 scatters(0), passes(1);  // how likely either is, as each channel would have it
  for (int c = 0; c < 3; ++c) {
    if (!(scatterers[c] > 0) || !(held[c] > 0)) continue;
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
  const double distance_m =
      way < by_angle ? lights.distance_at(place)
                     : air.distance_at(chosen, std::min(-std::log1p(-place * held[chosen]), air.whole_depth()[chosen]));
  step.scattered = true;
  step.through = glm::dvec3(0);
  step.position = origin + direction * distance_m;
  if (!std::isfinite(distance_m)) return step;
  const glm::dvec3 here = left_of(air.depth(distance_m)), extinction = air.extinction(distance_m);
  double density = 0;  // per metre of the ray
  for (int c = 0; c < 3; ++c)
    if (scatters[c] > 0) density += (1 - by_angle) * likely[c] * scatters[c] * extinction[c] * here[c] / held[c];
  if (by_angle > 0) density += by_angle * glm::dot(likely, scatters) * lights.density(distance_m);
  if (!(density > 0)) return step;
  // One of the media scatters, as likely as it would.
  double weights = 0, left_weight = 0;
  size_t scatterer = 0;
  const auto weight_of = [&](size_t i) {
    return glm::dot(through, media[i].scattering()) * air.density(i, distance_m);
  };
  for (size_t i = 0; i < media.size(); ++i) weights += weight_of(i);
  if (!(weights > 0)) return step;
  double u = which;
  for (left_weight = u * weights; scatterer + 1 < media.size() && left_weight >= weight_of(scatterer); ++scatterer)
    left_weight -= weight_of(scatterer);
  const double own = weight_of(scatterer);
  if (!(own > 0)) return step;
  if (media.size() > 1) u = std::clamp(left_weight / own, 0.0, std::nextafter(1.0, 0.0));
  const double g = media[scatterer].anisotropy();
  step.through =
      through * media[scatterer].scattering() * (air.density(scatterer, distance_m) * weights / own) * here / density;
  out.radiance += step.through * fog_event(step.position, direction, g, every, u, stream, sky);
  step.direction = sample_henyey_greenstein(direction, g, for_direction);
  step.density = henyey_greenstein(glm::dot(step.direction, direction), g);
  if (!survives(roulette, bounce + 1, step.through)) step.through = glm::dvec3(0);
  return step;
}

// Light that comes straight from its source to a place in fog and is scattered into the direction of travel towards it,
// turned around: every directional light, one direction of the sky, and lights of the tree.
glm::dvec3 Integrator::fog_event(glm::dvec3 position, glm::dvec3 direction, double g, bool every, double which,
                                 SampleStream& stream, glm::dvec3 sky, const Interior* body) const {
  const SurfacePoint point{position, {}, 0};
  const auto phase = [&](glm::dvec3 l) { return henyey_greenstein(glm::dot(l, direction), g); };
  const auto arrives = [&](const Offer& offer) {
    const glm::dvec3 light =
        body ? offer.radiance : offer.radiance * world_.through_fog(position, offer.l, offer.distance_m);
    if (light == glm::dvec3(0)) return light;
    return light * light_through(world_, point, offer.l, offer.distance_m, body, offer.end ? &*offer.end : nullptr,
                                 offer.is_lamp());
  };
  const glm::dvec2 for_sky = stream.next2(), on_light = stream.next2();
  const double pick = stream.next();
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
      const double fraction = p * weight(choice.pdf, p, Strategy::light) / choice.pdf;
      sum += sky * arrives({world_.sky().radiance(choice.direction) * fraction, choice.direction, endless, {}});
    }
  const size_t points = world_.tree_punctual().size();
  const auto make = [&](const LightTree::Choice& choice, size_t number, bool is_lamp) -> Offer {
    if (is_lamp) {
      Offer offer =
          punctual_offer_of(world_.punctual_lights()[world_.tree_punctual()[choice.light]], number, choice.probability);
      offer.radiance /= choice.probability;
      return offer;
    }
    if (settings_.strategy == Strategy::brdf) return {};
    const auto p =
        emissive_point(uint32_t(choice.light - points), choice.probability, position, own_place(on_light, number));
    if (!p) return {};
    const double f = phase(p->l);
    return {radiance_of(*p) * (f * weight(p->pdf, f, Strategy::light) / p->pdf), p->l, p->distance_m, surface_of(*p)};
  };
  return sum + by_tree(position, glm::dvec3(0), which, pick, every, make,
                       [&](const Offer& offer, const LightTree::Choice&) { return arrives(offer); });
}

}  // namespace candela::reference
