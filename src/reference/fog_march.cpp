// Fog as direct sees it: what the medium emits, and light that is scattered once on its way from its source.
//
// Every light that reaches the ray is summed, and its integral along it is estimated at fog_steps points. They lie in
// strata of equal fraction - one point in each - under two densities, weighted by the power heuristic of Veach: by
// transmittance towards the camera (for every extinction that a colour channel has), whose weights are the exact
// energy-conserving integral (1 - e^-x) of each stratum, and, for lights with a place, mostly equi-angular about the
// light (Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012), which
// takes the inverse square out. All strata of a sample share one random offset, mirrored in every other one, so that on
// smooth stretches the error falls with the square of the steps; the offset makes the mean of the samples right for any
// number.
//
// Where more than fog_lights point lights and spots reach the ray, as many points as these would have are shared out
// among all by what each gives (lamps_along_ray.h). Strata and offset are then those of the sum of all shares, and the
// densities count the points that a light has on average.
#include <algorithm>
#include <cmath>

#include "reference/equi_angular.h"
#include "reference/integrator.h"
#include "reference/lamps_along_ray.h"
#include "reference/visibility.h"

namespace candela::reference {
namespace {

constexpr uint32_t first_march_dimension = 1u << 21;
constexpr uint32_t march_step_dimensions = 8;

double stratum(int j, int count, double offset) { return (j + (j % 2 == 0 ? offset : 1 - offset)) / count; }

// A stretch of a ray inside the medium, from the bound or the last surface to the next, and the densities of points on
// it.
//
// Of several media each is marched for itself, and what the others take away is a factor of each point.
class Stretch {
 public:
  Stretch(const std::vector<Medium>& media, size_t which, glm::dvec3 origin, glm::dvec3 direction, Span span)
      : media_(&media),
        which_(which),
        medium_(media[which]),
        origin_(origin),
        direction_(direction),
        span_(medium_.inside(origin, direction, span)) {
    const Medium& medium = medium_;
    before_ = medium.length(origin, direction, medium.inside(origin, direction, {0, span.begin_m}));
    length_ = medium.length(origin, direction, span_);
    double thinnest = endless;
    for (int c = 0; c < 3; ++c) {
      const double extinction = medium.extinction()[c];
      if (!(medium.scattering()[c] > 0)) continue;
      thinnest = std::min(thinnest, extinction);
      bool known = false;
      for (int k = 0; k < kinds_; ++k) known = known || extinctions_[k] == extinction;
      if (!known) extinctions_[kinds_++] = extinction;
    }
    cut(deepest / thinnest - before_);
  }
  Stretch part(Span span) const {
    Stretch p = *this;
    p.span_ = {std::max(span.begin_m, span_.begin_m), std::min(span.end_m, span_.end_m)};
    if (p.span_.empty()) return p;
    p.before_ += medium_.length(origin_, direction_, {span_.begin_m, p.span_.begin_m});
    p.length_ = medium_.length(origin_, direction_, p.span_);
    return p;
  }
  bool empty() const { return span_.empty() || !(length_ > 0); }
  const Span& span() const { return span_; }
  int kinds() const { return kinds_; }
  double depth() const {
    return *std::max_element(extinctions_, extinctions_ + 3) * length_;
  }  // optical, of the most opaque channel

  struct Place {
    double distance_m = 0, length = 0;  // along the ray; from the stretch's begin
    glm::dvec3 position{0};
  };
  Place place(double distance_m) const {
    return {distance_m, medium_.length(origin_, direction_, {span_.begin_m, distance_m}),
            origin_ + direction_ * distance_m};
  }
  // By transmittance, as extinction number `kind` has it.
  Place by_transmittance(int kind, double u) const {
    const double sigma = extinctions_[kind];
    const double length = std::min(-std::log1p(u * std::expm1(-sigma * length_)) / sigma, length_);
    const double at = std::min(medium_.distance_at(origin_, direction_, span_.begin_m, length), span_.end_m);
    return {at, length, origin_ + direction_ * at};
  }
  // Density per metre of medium (not of the ray) of that way to choose.
  double density(int kind, const Place& p) const {
    const double sigma = extinctions_[kind];
    return std::exp(-sigma * p.length) /
           (std::isinf(length_) ? 1 / sigma : length_ * one_minus_exp_over(sigma * length_));
  }
  // Of light that a metre of medium at p scatters towards the camera, the part that arrives there.
  glm::dvec3 towards_camera(const Place& p) const {
    glm::dvec3 light = medium_.scattering() * medium_.through(before_ + p.length);
    for (size_t i = 0; i < media_->size(); ++i)
      if (i != which_) light *= (*media_)[i].transmittance(origin_, direction_, p.distance_m);
    return light;
  }
  double medium_a_metre(const Place& p) const { return medium_.density(p.position); }

 private:
  void cut(double longest) {
    if (!(longest > 0) || kinds_ == 0) {
      length_ = 0;
    } else if (longest < length_) {
      length_ = longest;
      span_.end_m = std::min(span_.end_m, medium_.distance_at(origin_, direction_, span_.begin_m, longest));
    }
  }

  const std::vector<Medium>* media_;
  size_t which_;
  const Medium& medium_;
  glm::dvec3 origin_, direction_;
  Span span_;
  double before_ = 0, length_ = 0;  // metres at density 1
  double extinctions_[3] = {};
  int kinds_ = 0;
};

// How many of `count` points each way to choose a place gets: equal angles, where the light has a place, and
// transmittance as each extinction has it. Measured on a street of 256 lamps, angles alone have the least noise where
// fog is thin on a light's part of the ray; through many mean free paths they waste their points, so transmittance gets
// up to half of them.
struct Points {
  double by_angle = 0, of_kind[3] = {};
};
double share_of_transmittance(const Stretch& stretch) { return 0.5 * (1 - one_minus_exp_over(stretch.depth())); }
Points points_on(const Stretch& stretch, int count, bool has_place) {
  Points points;
  const int by_transmittance = has_place ? int(share_of_transmittance(stretch) * count) : count;
  points.by_angle = count - by_transmittance;
  for (int k = 0; k < stretch.kinds(); ++k)
    points.of_kind[k] = by_transmittance / stretch.kinds() + (k < by_transmittance % stretch.kinds());
  return points;
}
// The same of so many on average.
Points mean_points_on(const Stretch& stretch, double count) {
  Points points;
  const double fraction = share_of_transmittance(stretch);
  points.by_angle = (1 - fraction) * count;
  for (int k = 0; k < stretch.kinds(); ++k) points.of_kind[k] = fraction * count / stretch.kinds();
  return points;
}

// A place that several ways might have chosen, by the power heuristic: points times density of each, per metre of
// medium. Under the balance heuristic a stray point that another colour's way puts where this colour's are dense would
// count like one of them.
struct Weighed {
  double own = 0, squares = 0;
  void add(double density, bool is_own) {
    squares += density * density;
    if (is_own) own = density;
  }
  double density() const { return squares / own; }  // what the point's light is divided by
};

// A light's part of a stretch, and the ways to choose places on it: -1 by angle, else by transmittance as one of the
// kinds of extinction has it.
class LitStretch {
 public:
  LitStretch(const Stretch& all, const PunctualLight& light, glm::dvec3 origin, glm::dvec3 direction)
      : angles_(origin, direction, light.position),
        has_place_(light.type != LightType::directional),
        stretch_(has_place_ ? all.part(lit_part(light, origin, direction, all.span())) : all) {
    if (has_place_ && !stretch_.empty()) angles_.limit(stretch_.span());
  }
  bool empty() const { return stretch_.empty(); }
  bool has_place() const { return has_place_; }
  const Stretch& stretch() const { return stretch_; }
  Stretch::Place place(int way, double u) const {
    return way < 0 ? stretch_.place(angles_.distance_at(u)) : stretch_.by_transmittance(way, u);
  }
  // What a point's light is divided by, per metre of medium.
  double density(const Points& points, int way, const Stretch::Place& p) const {
    Weighed weighed;
    for (int k = 0; k < stretch_.kinds(); ++k) weighed.add(points.of_kind[k] * stretch_.density(k, p), k == way);
    if (has_place_) weighed.add(points.by_angle * angles_.density(p.distance_m) / stretch_.medium_a_metre(p), way < 0);
    return weighed.density();
  }

 private:
  EquiAngular angles_;
  bool has_place_;
  Stretch stretch_;
};

}  // namespace

glm::dvec3 Integrator::fog_before(glm::dvec3 origin, glm::dvec3 direction, Span span, double fraction, uint32_t layer,
                                  SampleStream& stream, PixelSample& out) const {
  if (world_.media().empty()) return glm::dvec3(1);
  const glm::dvec3 light = fraction * fog_light(origin, direction, span, layer, stream);
  out.radiance += light;
  out.fog_light += light;
  return world_.through_fog(origin, direction, span.end_m);
}

// Radiance at a place in fog that the sky sends there and the fog scatters into the ray, over the scattering
// coefficient.
glm::dvec3 Integrator::fog_ambient(glm::dvec3 position, glm::dvec3 direction, double g, SampleStream& stream) const {
  const auto open = [&](glm::dvec3 l) {
    const glm::dvec3 clear = world_.through_fog(position, l, endless);
    if (clear == glm::dvec3(0) || !settings_.visibility) return clear;
    return clear * transmittance(world_, {position, {}, 0}, l, settings_.ambient_distance_m);
  };
  const glm::dvec3 onward = sample_henyey_greenstein(direction, g, stream.next2());
  if (settings_.ambient == Ambient::occlusion) {
    // A harmonic of degree l keeps g^l of itself; the coefficients come with the cosine lobe's 1, 2/3 and 1/4.
    const glm::dvec3 sky = harmonic_sum(world_.ambient_sh(), direction, {1, 1.5 * g, 4 * g * g});
    return sky == glm::dvec3(0) ? sky : sky * open(onward);
  }
  glm::dvec3 sum(0);
  const auto add = [&](glm::dvec3 l, double pdf, double other, double phase) {
    if (!(pdf > 0)) return;
    const glm::dvec3 radiance = world_.sky().radiance(l) * (phase * pdf / (pdf * pdf + other * other));
    if (radiance != glm::dvec3(0)) sum += radiance * open(l);
  };
  const double phase = henyey_greenstein(glm::dot(onward, direction), g);
  add(onward, phase, world_.sky().pdf(onward), phase);
  const Sky::Choice choice = world_.sky().sample(stream.next2());
  const double of_choice = henyey_greenstein(glm::dot(choice.direction, direction), g);
  add(choice.direction, choice.pdf, of_choice, of_choice);
  return sum;
}

// What the medium emits towards the ray's origin. Alone it is a constant source over extinction, whatever the density
// does; what others take away of it is asked at points that follow its own transmittance.
glm::dvec3 Integrator::fog_glow(size_t which, glm::dvec3 origin, glm::dvec3 direction, Span span, double offset) const {
  const std::vector<Medium>& media = world_.media();
  const Medium& medium = media[which];
  const Span inside = medium.inside(origin, direction, span);
  const double length = medium.length(origin, direction, inside);
  glm::dvec3 glow = medium.glow() * medium.transmittance(origin, direction, span.begin_m) * medium.held(length);
  if (media.size() == 1 || glow == glm::dvec3(0)) return glow;
  for (int c = 0; c < 3; ++c) {
    if (!(glow[c] > 0)) continue;
    const double sigma = medium.extinction()[c];
    const int steps = std::max(settings_.fog_steps, 1);  // path takes one place
    double left = 0;
    for (int j = 0; j < steps; ++j) {
      const double u = stratum(j, steps, offset);
      const double way = std::min(-std::log1p(u * std::expm1(-sigma * length)) / sigma, length);
      const double at = std::min(medium.distance_at(origin, direction, inside.begin_m, way), inside.end_m);
      double through = 1;
      for (size_t i = 0; i < media.size(); ++i)
        if (i != which) through *= media[i].transmittance(origin, direction, at)[c];
      left += through;
    }
    glow[c] *= left / steps;
  }
  return glow;
}

glm::dvec3 Integrator::fog_light(glm::dvec3 origin, glm::dvec3 direction, Span span, uint32_t layer,
                                 SampleStream& stream) const {
  glm::dvec3 sum(0);
  for (size_t which = 0; which < world_.media().size(); ++which)
    sum += fog_light_of(which, origin, direction, span, layer, stream);
  return sum;
}

glm::dvec3 Integrator::fog_light_of(size_t which, glm::dvec3 origin, glm::dvec3 direction, Span span, uint32_t layer,
                                    SampleStream& stream) const {
  const Medium& medium = world_.media()[which];
  const uint32_t steps = uint32_t(settings_.fog_steps), media = uint32_t(world_.media().size());
  const uint32_t dimension =
      first_march_dimension + (layer * media + uint32_t(which)) * (4 + steps * march_step_dimensions);
  glm::dvec3 sum(0);
  if (medium.glows()) {
    double offset = 0.5;
    if (media > 1) {
      stream.start(dimension + 3);
      offset = stream.next();
    }
    sum = fog_glow(which, origin, direction, span, offset);
  }
  const Stretch all(world_.media(), which, origin, direction, span);
  if (!medium.scatters() || all.empty()) return sum;

  stream.start(dimension);
  const double first_offset = stream.next();
  const glm::dvec2 on_disc = stream.next2();
  const double g = medium.anisotropy();
  uint32_t place = 0;
  const auto follow = [&](const PunctualLight& light, const LitStretch& lit, const Points& points, int way, double u) {
    const Stretch::Place p = lit.place(way, u);
    if (!std::isfinite(p.distance_m)) return;
    const Arrival a = arriving(light, p.position, own_place(on_disc, place++));
    if (a.illuminance == glm::dvec3(0)) return;
    const double chosen = lit.density(points, way, p);
    if (!(chosen > 0)) return;
    const glm::dvec3 light_here = lit.stretch().towards_camera(p) * a.illuminance *
                                  (henyey_greenstein(glm::dot(a.l, direction), g) / chosen) *
                                  world_.through_fog(p.position, a.l, a.distance_m);
    if (light_here == glm::dvec3(0)) return;
    sum += settings_.visibility ? light_here * transmittance(world_, {p.position, {}, 0}, a.l, a.distance_m, nullptr,
                                                             std::isfinite(a.distance_m))
                                : light_here;
  };
  const auto follow_all = [&](uint32_t index) {
    const PunctualLight& light = world_.punctual_lights()[index];
    const LitStretch lit(all, light, origin, direction);
    if (lit.empty()) return;
    double offset = first_offset + 0.6180339887498949 * index;
    offset -= std::floor(offset);
    const Points points = points_on(lit.stretch(), settings_.fog_steps, lit.has_place());
    for (int way = -1; way < lit.stretch().kinds(); ++way) {
      const int count = int(way < 0 ? points.by_angle : points.of_kind[way]);
      for (int j = 0; j < count; ++j) follow(light, lit, points, way, stratum(j, count, offset));
    }
  };
  for (const uint32_t index : world_.directional()) follow_all(index);
  const LampsAlongRay lamps(world_, origin, direction, all.span(), g,
                            [&](double at_m, glm::dvec3 position, glm::dvec3 l, double distance_m) {
                              return world_.through_fog(origin, direction, at_m) *
                                     world_.through_fog(position, l, distance_m) * medium.density(position);
                            });
  static thread_local std::vector<uint32_t> reaching;
  const size_t most = settings_.fog_lights > 0 ? size_t(settings_.fog_lights) : world_.punctual_lights().size();
  if (lamps.reaching(most, reaching)) {
    for (const uint32_t index : reaching) follow_all(index);
  } else {
    static thread_local std::vector<LampsAlongRay::Point> chosen;
    lamps.choose(settings_.fog_steps * settings_.fog_lights, first_offset, chosen);
    for (size_t i = 0; i < chosen.size();) {
      const PunctualLight& light = world_.punctual_lights()[chosen[i].light];
      const LitStretch lit(all, light, origin, direction);
      const Points points = mean_points_on(lit.stretch(), chosen[i].expected);
      for (const uint32_t same = chosen[i].light; i < chosen.size() && chosen[i].light == same; ++i) {
        if (lit.empty()) continue;
        // The ways lie beside each other in the light's fraction.
        double u = chosen[i].u * chosen[i].expected;
        int way = -1;
        double own = points.by_angle;
        while (u >= own && way + 1 < lit.stretch().kinds()) u -= own, own = points.of_kind[++way];
        if (own > 0) follow(light, lit, points, way, std::clamp(u / own, 0.0, 1 - 0x1p-53));
      }
    }
  }
  if (!world_.sky() || settings_.ambient == Ambient::off) return sum;
  uint32_t step = 0;
  const Points points = points_on(all, settings_.fog_steps, false);
  for (int kind = 0; kind < all.kinds(); ++kind) {
    for (int j = 0; j < points.of_kind[kind]; ++j) {
      const Stretch::Place p = all.by_transmittance(kind, stratum(j, points.of_kind[kind], first_offset));
      if (!std::isfinite(p.distance_m)) continue;
      Weighed weighed;
      for (int k = 0; k < all.kinds(); ++k) weighed.add(points.of_kind[k] * all.density(k, p), k == kind);
      const double chosen = weighed.density();
      stream.start(dimension + 4 + step++ * march_step_dimensions);
      if (chosen > 0) sum += all.towards_camera(p) / chosen * fog_ambient(p.position, direction, g, stream);
    }
  }
  return sum;
}

}  // namespace candela::reference
