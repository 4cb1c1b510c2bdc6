// Full transport of light: paths from the camera, a light chosen at every surface, and both ways of meeting a light
// weighted (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997).
#include <cmath>

#include "reference/glass_light.h"
#include "reference/integrator.h"

namespace candela::reference {
namespace {

constexpr int roulette_after = 4;
constexpr int shadowed_bounces =
    1;  // surfaces at which each light that is chosen gets a shadow ray: what the camera sees
constexpr uint32_t first_lamp_dimension = 1u << 24;
constexpr uint32_t first_body_dimension = 1u << 25, body_dimensions_a_bounce = 1u << 16;
constexpr uint32_t dimensions_a_bounce = 16, first_alpha_dimension = 1u << 20;
constexpr int most_events = 1 << 16;  // of one path: no end of a loop must hang on arithmetic

bool emits_towards(const World& world, const Hit& hit) { return !hit.back || world.is_double_sided(hit.item); }

}  // namespace

double Integrator::weight(double this_pdf, double other_pdf, Strategy own) const {
  if (settings_.strategy != Strategy::both) return settings_.strategy == own ? 1 : 0;
  if (!(this_pdf > 0)) return 0;
  const double r = other_pdf / this_pdf;
  return 1 / (1 + r * r);
}

std::optional<Integrator::EmissivePoint> Integrator::emissive_point(uint32_t light, double probability, glm::dvec3 from,
                                                                    glm::dvec2 u) const {
  if (light >= world_.emissive().size()) {
    const GlowingBody& body = world_.glowing()[light - world_.emissive().size()];
    const auto met = body.sample(from, u);
    if (!met || (met->back && !body.two_sided())) return std::nullopt;
    const double density = body.density(from, met->direction);
    if (!(density > 0)) return std::nullopt;
    Hit hit{.item = body.item(), .back = met->back};
    hit.point = from + met->distance_m * met->direction;
    return EmissivePoint{met->direction, met->distance_m, probability * density, light, {}, met->back, hit};
  }
  const EmissiveTriangle& t = world_.emissive()[light];
  const double root = std::sqrt(u.x);
  const glm::dvec2 b(root * (1 - u.y), root * u.y);
  const glm::dvec3 to_light = (1 - b.x - b.y) * t.corner[0] + b.x * t.corner[1] + b.y * t.corner[2] - from;
  const double d2 = glm::dot(to_light, to_light);
  if (!(d2 > 0)) return std::nullopt;
  const double distance_m = std::sqrt(d2);
  const glm::dvec3 l = to_light / distance_m;
  const double facing = -glm::dot(t.normal, l);
  if (facing == 0 || (facing < 0 && !t.two_sided)) return std::nullopt;
  return EmissivePoint{l, distance_m, probability * d2 / (std::abs(facing) * t.area_m2), light, b, facing < 0};
}

glm::dvec3 Integrator::radiance_of(const EmissivePoint& p) const {
  const auto given = [](const Surface& emitter) { return emitter.emission * emitter.coverage; };
  if (p.of_body) return given(world_.surface(*p.of_body, glm::dvec3(p.of_body->point) - p.distance_m * p.l, p.l));
  const EmissiveTriangle& t = world_.emissive()[p.light];
  return given(world_.surface_at(t.item, t.primitive, p.at, p.back, -p.l));
}

SurfacePoint Integrator::surface_of(const EmissivePoint& p) const {
  if (p.of_body) return world_.accel().surface(*p.of_body);
  const EmissiveTriangle& t = world_.emissive()[p.light];
  return world_.accel().surface({0, float(p.at.x), float(p.at.y), t.item, t.primitive, p.back});
}

// Of a place of a body, if it would be found: the first one that is met on the way there.
double Integrator::chosen_density(size_t body, glm::dvec3 from, glm::dvec3 way) const {
  const double distance_m = glm::length(way);
  if (!(distance_m > 0)) return 0;
  const auto met = world_.glowing()[body].first(from, way / distance_m);
  constexpr double nearly = 1e-4;
  if (!met || std::abs(met->distance_m - distance_m) > nearly * distance_m) return 0;
  return world_.glowing()[body].density(from, way / distance_m);
}

// The light of one triangle or body by way of one point on it.
Integrator::Offer Integrator::emissive_offer(uint32_t light, double probability, const Surface& s, glm::dvec3 v,
                                             glm::dvec2 u) const {
  const auto p = emissive_point(light, probability, s.position, u);
  if (!p || !is_open(s, p->l)) return {};
  const glm::dvec3 f = evaluate_bsdf(s, p->l, v);
  if (f == glm::dvec3(0)) return {};
  const glm::dvec3 radiance = radiance_of(*p) * f * (weight(p->pdf, bsdf_pdf(s, p->l, v), Strategy::light) / p->pdf);
  if (radiance == glm::dvec3(0)) return {};
  return {radiance, p->l, p->distance_m, surface_of(*p)};
}

template <class Left, class Gain>
void Integrator::meet_lamps(const Departure& from, const Departure& came, glm::dvec3 geometric, glm::dvec3 direction,
                            Span between, Left&& left, Gain&& gain) const {
  static thread_local std::vector<uint32_t> lamps;
  world_.light_tree().met(from.position, direction, lamps);
  for (const uint32_t lamp : lamps) {
    const PunctualLight& light = world_.punctual_lights()[world_.tree_punctual()[lamp]];
    const std::optional<Arrival> a = light_in(light, from.position, direction);
    if (!a || !(a->distance_m >= between.begin_m && a->distance_m < between.end_m)) continue;
    double w = 1;
    if (from.density > 0) {
      const double by_choice =
          world_.light_tree().probability(lamp, from.position, from.normal, true) * a->pdf / from.density;
      const double by_rays = lamp_rays(came, from.position, geometric, lamp, direction) / from.density;
      w = by_rays > 0 ? 1 / (1 + by_choice * by_choice + by_rays * by_rays)
                      : weight(from.density, by_choice * from.density, Strategy::brdf);
    }
    const glm::dvec3 light_here = a->illuminance * (a->pdf * w);
    if (light_here != glm::dvec3(0)) gain(light, light_here * left(a->distance_m));
  }
}

bool Integrator::OneOf::consider(const Offer& other, double weight, double& u) {
  if (!(weight > 0)) return false;
  total_ += weight;
  const double fraction = weight / total_;
  if (u < fraction) {
    offer = other, weight_ = weight;
    u = std::min(u / fraction, 1 - 0x1p-53);
    return true;
  }
  u = std::min((u - fraction) / (1 - fraction), 1 - 0x1p-53);
  return false;
}

glm::dvec2 Integrator::own_place(glm::dvec2 first, size_t light) {
  const glm::dvec2 turned = first + double(light) * glm::dvec2(0.7548776662466927, 0.5698402909980532);
  return turned - glm::floor(turned);
}

bool Integrator::survives(double u, int bounce, glm::dvec3& through, double compressed) {
  if (bounce <= roulette_after) return true;
  const double survive = std::min(largest(through) / compressed, 0.95);
  if (!(u < survive)) return false;
  through /= survive;
  return true;
}

// Every directional light, one direction of the sky, and lights of the tree: those about the point each, and some of
// those farther off. Where not every one of them is worth a shadow ray, one is.
glm::dvec3 Integrator::next_event(const Surface& s, const SurfacePoint& point, glm::dvec3 v, bool every,
                                  SampleStream& stream, TermSample* terms, const Departure* from,
                                  glm::dvec3 sky) const {
  const glm::dvec2 for_sky = stream.next2();
  const double which = stream.next();
  const double pick = stream.next();
  const glm::dvec2 on_light = stream.next2(), on_disc = stream.next2();
  glm::dvec3 sum(0);
  for (const uint32_t index : world_.directional()) {
    const glm::dvec3 radiance =
        taken(punctual_offer(world_.punctual_lights()[index], s, v, own_place(on_disc, index)), s, point);
    sum += radiance;
    if (terms) terms->add_direct(world_.punctual_lights()[index], radiance);
  }
  if (world_.sky() && settings_.strategy != Strategy::brdf) {
    const Sky::Choice choice = world_.sky().sample(for_sky);
    const glm::dvec3 f = choice.pdf > 0 ? evaluate_bsdf(s, choice.direction, v) : glm::dvec3(0);
    if (f != glm::dvec3(0)) {
      const double w = weight(choice.pdf, bsdf_pdf(s, choice.direction, v), Strategy::light);
      const glm::dvec3 radiance = world_.sky().radiance(choice.direction) * f * (w / choice.pdf);
      if (radiance != glm::dvec3(0)) {
        const glm::dvec3 arriving = radiance * sky * sky_visibility(s, point, choice.direction);
        sum += arriving;
        if (terms) terms->add_ambient(arriving * diffuse_share(s, choice.direction, v), arriving);
      }
    }
  }
  const size_t points = world_.tree_punctual().size();
  const auto lamp = [&](const LightTree::Choice& choice) -> const PunctualLight& {
    return world_.punctual_lights()[world_.tree_punctual()[choice.light]];
  };
  const auto make = [&](const LightTree::Choice& choice, size_t number, bool is_lamp) {
    Offer offer;
    if (is_lamp) {
      const LampRays rays{from, choice.light};
      offer =
          punctual_offer(lamp(choice), s, v, own_place(on_light, number), choice.probability, from ? &rays : nullptr);
      offer.radiance /= choice.probability;
    } else if (settings_.strategy != Strategy::brdf) {
      offer = emissive_offer(uint32_t(choice.light - points), choice.probability, s, v, own_place(on_light, number));
    }
    return is_open(s, offer.l) ? offer : Offer{};
  };
  return sum + by_tree(s.position, lit_side(s), which, pick, every, make,
                       [&](const Offer& offer, const LightTree::Choice& choice) {
                         const glm::dvec3 radiance = taken(offer, s, point);
                         if (terms && choice.light < points)
                           terms->add_direct(lamp(choice), radiance);
                         else if (terms)
                           (*terms)[Term::indirect] += radiance;
                         return radiance;
                       });
}

template <class Stretch, class Emission>
glm::dvec3 Integrator::light_behind(const Ray& ray, const Hit& face, double face_m, glm::dvec3 origin,
                                    glm::dvec3 direction, GlassWay way, Stretch&& stretch, Emission&& emission) const {
  glm::dvec3 left(1);
  Hit passed = face;
  double from_m = face_m;
  for (int event = 0; event < most_events; ++event) {
    const std::optional<Hit> hit = next_surface(world_, ray, false, &passed, nullptr);
    Surface s = hit ? world_.surface(*hit, origin, direction) : Surface{};
    const double here_m = hit ? glm::dot(s.position - origin, direction) : endless;
    stretch(Span{from_m, here_m}, way, left);
    if (!hit) return left * way.end(endless);
    if (world_.has_glass()) left *= way.arrive(s, -direction, hit->back, here_m);
    if (!s.unlit && s.emission != glm::dvec3(0) && emits_towards(world_, *hit))
      emission(*hit, s, here_m, left * s.coverage);
    if (!passes_light(world_, *hit, LightAlong::to_origin)) {
      glm::dvec3 through(1 - s.coverage);
      if (world_.has_glass()) through += s.coverage * straight_share(s, -direction);
      left *= through;
      if (left == glm::dvec3(0)) return left;
    }
    if (world_.has_glass() && is_straight(s)) way.cross();
    passed = *hit, from_m = here_m;
  }
  return glm::dvec3(0);
}

// Glass has lights of its own ways, which a lamp's rays do not know.
bool Integrator::joins_lamps(int bounce) const {
  if (!settings_.lamp_rays || settings_.strategy != Strategy::both) return false;
  if (world_.has_glass() || world_.lamp_tree().empty()) return false;
  return settings_.most_bounces == 0 || bounce + 1 < settings_.most_bounces;
}

PixelSample Integrator::sample_path(const CameraRay& camera, const std::optional<Hit>& first_hit, SampleStream& stream,
                                    TermSample* terms, TraceCounts* counts) const {
  PixelSample out;
  glm::dvec3 through(1), origin = camera.origin, direction = camera.direction;
  Ray ray = rounded(camera);
  std::optional<Hit> passed;
  // Of the bounce that the ray comes from; the camera's first ray meets lights by itself alone, and so does one from a
  // mirror.
  Departure left, came;  // from the last surface, and to it
  glm::dvec3 left_geometric(0);
  bool from_mirror = false;
  uint32_t alpha_dimension = first_alpha_dimension;
  int bounce = 0;
  // Surfaces, among them those that the ray goes straight through, spans of fog, and those of bodies that scatter.
  uint32_t shaded = 0, fogged = 0, walked = 0;
  GlassWay way;
  double compressed = 1;     // what refraction has made of radiance alone, not of its fraction
  double clear_m = 0;        // fog up to here is behind the ray already
  double lamps_m = 0;        // and lamps with a radius
  glm::dvec3 sky(1);         // share of the sky's light that counts
  glm::dvec3 seen(1);        // what fog leaves of what the camera sees
  bool in_fog = false;       // the camera's ray ended there
  glm::dvec3 before_fog(0);  // light of surfaces that it went straight through before
  glm::dvec3 diffuse(0);     // share of the first surface's light in the direction of the first bounce
  const auto gain = [&](Term term, glm::dvec3 light) {
    out.radiance += light;
    if (terms && !in_fog) (*terms)[term] += light;
  };
  // Of a light that the ray meets by itself.
  const auto gain_of = [&](const PunctualLight& from, glm::dvec3 light) {
    if (bounce > 1) return gain(Term::indirect, light);
    out.radiance += light;
    if (terms && !in_fog) terms->add_direct(from, light);
  };
  const std::optional<RayDifferential> part = footprint();
  // Of a light that the ray meets by itself, against its choice at the surface that the ray left.
  const auto weight_of_emission = [&](const Hit& hit, const Surface& at, glm::dvec3 v) {
    const int light = bounce == 0 || from_mirror ? -1 : world_.emissive_of(hit.item, hit.primitive);
    if (light < 0) return 1.0;
    const glm::dvec3 d = at.position - left.position;
    const double probability = world_.light_tree().probability(
        uint32_t(world_.tree_punctual().size()) + uint32_t(light), left.position, left.normal, true);
    double density = 0;
    if (size_t(light) < world_.emissive().size()) {
      const EmissiveTriangle& t = world_.emissive()[size_t(light)];
      density = glm::dot(d, d) / (std::abs(glm::dot(t.normal, v)) * t.area_m2);
    } else {
      density = chosen_density(size_t(light) - world_.emissive().size(), left.position, d);
      if (density == 0) return 1.0;
    }
    return weight(left.density, probability * density, Strategy::brdf);
  };
  // What a ray from a surface finds of sky and suns where it leaves the scene, as `open` of them is left.
  const auto leave = [&](glm::dvec3 v, glm::dvec3 open) {
    if (world_.sky()) {
      const double w = from_mirror ? 1 : weight(left.density, world_.sky().pdf(direction), Strategy::brdf);
      const glm::dvec3 light = through * (sky * open) * world_.sky().radiance(direction) * w;
      if (bounce > 1) {
        gain(Term::indirect, light);
      } else {
        out.radiance += light;
        if (terms && !in_fog) terms->add_ambient(light * diffuse, light);
      }
    }
    if (world_.has_sized_lights())
      for (const uint32_t index : world_.directional())
        if (const auto a = light_in(world_.punctual_lights()[index], left.position, -v)) {
          const double w = from_mirror ? 1 : weight(left.density, a->pdf, Strategy::brdf);
          gain_of(world_.punctual_lights()[index], through * open * a->illuminance * (a->pdf * w));
        }
  };
  for (int event = 0; event < most_events; ++event) {
    const bool first = bounce == 0;
    const std::optional<Hit> hit =
        event == 0 ? first_hit
                   : next_surface(world_, ray, first, passed ? &*passed : nullptr, first ? counts : nullptr);
    Surface s = hit ? world_.surface(*hit, origin, direction, first && part ? &*part : nullptr) : Surface{};
    const glm::dvec3 v = -glm::normalize(direction);
    const double here_m = hit ? glm::dot(s.position - origin, -v) : endless;
    const bool in_body = way.in_body();
    if (!first && world_.light_tree().has_spheres()) {
      const glm::dvec3 before = through;
      meet_lamps(
          left, came, left_geometric, direction, {lamps_m, here_m},
          [&](double at_m) {
            const double in_fog_m = in_body ? 0 : std::max(at_m - clear_m, 0.0);
            return before * way.end(at_m) * world_.through_fog(origin - v * clear_m, -v, in_fog_m);
          },
          gain_of);
      lamps_m = here_m;
    }
    if (way.here().medium()) {
      const BodyStep step = body_step(way, origin, -v, here_m, through, compressed, bounce, walked++, stream, sky);
      gain(Term::indirect, step.light);
      through *= step.weight;
      if (through == glm::dvec3(0)) break;
      if (step.scattered) {
        if (first) bounce = 1, out.alpha = 1;
        from_mirror = false;
        left = {step.position, glm::dvec3(0), step.density}, came = {};
        passed.reset();
        ray = leaving_ray({step.position, {}, 0}, step.direction);
        origin = step.position, direction = step.direction, clear_m = lamps_m = 0;
        way.start_ray();
        continue;
      }
    }
    if (!hit) {
      through *= way.end(endless);
    } else if (world_.has_glass()) {
      if (way.splits(s)) {
        stream.start(alpha_dimension);
        alpha_dimension += 4;
        through *= way.choose_channel(s, stream.next());
      }
      through *= way.arrive(s, v, hit->back, glm::length(s.position - origin));
    }
    if (hit && s.coverage < 1) {
      // A blended surface is there as often as it covers.
      stream.start(alpha_dimension);
      alpha_dimension += 4;
      if (stream.next() >= s.coverage) {
        passed = *hit;
        continue;
      }
    }
    if (first) out.alpha = hit ? 1 : world_.background(direction).w;
    // Bodies of glass hold no fog.
    if (!world_.media().empty() && !in_body) {
      const glm::dvec3 light = out.radiance, of_surfaces = light - out.fog_light;
      const FogStep step = fog_step(origin - v * clear_m, -v, here_m - clear_m, through, bounce, fogged++,
                                    bounce < shadowed_bounces, stream, out, sky);
      if (first) {
        seen *= step.clear;
        out.fog_through = seen;
        out.alpha = 1 - luminance(seen) * (1 - out.alpha);
      }
      if (terms && !first && !in_fog) (*terms)[Term::indirect] += out.radiance - light;
      if (first && step.scattered) in_fog = true, before_fog = of_surfaces;
      through = step.through;
      if (through == glm::dvec3(0)) break;
      if (step.scattered) {
        ++bounce;
        from_mirror = false;
        left = {step.position, glm::dvec3(0), step.density}, came = {};
        passed.reset();
        ray = leaving_ray({step.position, {}, 0}, step.direction);
        origin = step.position, direction = step.direction, clear_m = lamps_m = 0;
        way.start_ray();
        continue;
      }
    }
    if (!hit) {
      if (first)
        gain(Term::background, through * glm::dvec3(world_.background(direction)));
      else
        leave(v, glm::dvec3(1));
      break;
    }
    // A face that light passes from behind: its lights behind reach the ray as they reach shadow rays, and what the
    // face itself sends is its own. Of the sky's light the face sends as much as does not come through it: no direction
    // then brings more than the sky, and a furnace of such faces gains nothing. Mirrors show it as the camera sees it.
    if (!first && !from_mirror && passes_light(world_, *hit, LightAlong::to_origin)) {
      const auto clear = [&](double at_m) {
        return in_body ? glm::dvec3(1) : world_.through_fog(s.position, -v, at_m - here_m);
      };
      const glm::dvec3 open =
          light_behind(
              ray, *hit, here_m, origin, -v, way,
              [&](Span span, const GlassWay& there, glm::dvec3 still) {
                if (world_.light_tree().has_spheres())
                  meet_lamps(
                      left, came, left_geometric, direction, span,
                      [&](double at_m) { return through * still * there.end(at_m) * clear(at_m); }, gain_of);
              },
              [&](const Hit& lamp, const Surface& at, double at_m, glm::dvec3 still) {
                gain(Term::indirect, through * still * clear(at_m) * at.emission * weight_of_emission(lamp, at, v));
              }) *
          clear(endless);
      leave(v, open);
      sky *= 1.0 - open;
    }
    if (s.unlit) {
      // A picture, not a lamp: it is seen, also in reflections, and takes no light and is not chosen as a light.
      gain(first ? Term::emission : Term::indirect, through * s.base_color);
      break;
    }
    if (s.emission != glm::dvec3(0) && emits_towards(world_, *hit)) {
      gain(first ? Term::emission : Term::indirect, through * s.emission * weight_of_emission(*hit, s, v));
    }
    // After the last bounce light still goes straight through what lies between.
    const bool last = settings_.most_bounces > 0 && bounce >= settings_.most_bounces;
    if (last && !is_straight(s)) break;
    const SurfacePoint point = world_.point(*hit);
    stream.start(4 + shaded++ * dimensions_a_bounce);
    const glm::dvec2 for_lobe = stream.next2();
    const double lobe = stream.next(), roulette = stream.next();
    TermSample own;
    const bool divided = terms && first;
    if (!last) {
      // What glows all over lets light of lamps through, so that their rays never end there.
      const bool joined = !first && left.joined && !world_.glows_all_over(hit->item);
      const glm::dvec3 light = through * next_event(s, point, v, bounce < shadowed_bounces, stream,
                                                    divided ? &own : nullptr, joined ? &left : nullptr, sky);
      if (divided)
        out.radiance += light, terms->add(own, through);
      else
        gain(Term::indirect, light);
      if (world_.bends_lamps()) {
        SampleStream apart = stream;
        apart.start(first_body_dimension + shaded * body_dimensions_a_bounce);
        gain(Term::indirect, through * by_bodies(s, point, v, bounce, apart));
      }
    }
    if (divided) {
      terms->shadow = sun_visibility(s, point, stream.next2());
      if (terms->wants_lamp_shadow)
        terms->lamp_shadow = lamp_visibility(s, point, stream.apart(first_size_dimension).next2());
      if (!world_.is_blended(hit->item)) terms->occlusion = near_occlusion(s, point, stream.next2());
    }

    const bool joins = joins_lamps(bounce);
    if (joins) {
      SampleStream apart = stream;
      apart.start(first_lamp_dimension + shaded * dimensions_a_bounce);
      gain(Term::indirect, through * by_lamp_rays(s, point, v, apart));
    }
    const std::optional<BsdfSample> next = sample_bsdf(s, v, lobe, for_lobe);
    if (!next || (last && !next->straight)) break;
    through *= next->weight;
    if (terms && first && !next->straight) diffuse = next->pdf > 0 ? diffuse_share(s, next->l, v) : glm::dvec3(0);
    if (next->through) way.cross();
    if (next->straight) {
      if (through == glm::dvec3(0)) break;
      passed = *hit, clear_m = here_m;
      continue;
    }
    passed.reset();
    if (next->through && s.glass && s.glass->body) compressed /= s.eta * s.eta;
    ++bounce;
    if (!survives(roulette, bounce, through, compressed) || through == glm::dvec3(0)) break;
    from_mirror = !(next->pdf > 0);
    came = first || world_.glows_all_over(hit->item) ? Departure{} : left;
    left = {s.position, lit_side(s), next->pdf, joins};
    left_geometric = s.geometric;
    ray = leaving_ray(point, next->l);
    origin = ray.origin, direction = next->l, clear_m = lamps_m = 0;
    way.start_ray();
  }
  if (in_fog) out.fog_light = out.radiance - before_fog;
  return out;
}

}  // namespace candela::reference
