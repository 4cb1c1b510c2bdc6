// Light of a lamp by way of a surface close to it.
//
// On a surface the light of a lamp falls with the square of the distance. A path that comes by chance to where a lamp
// hangs a hand's breadth from a wall finds there thousands of times what it finds elsewhere, once in as many paths: all
// the noise of a city's indirect light. So every such bounce is also made from its other end: a ray leaves the lamp,
// evenly over its directions, which makes places as likely as they are lit, and the surface that it meets is joined to
// the path's. Of the ways to make one path the power heuristic takes the likelier (Veach, "Robust Monte Carlo Methods
// for Light Transport Simulation", 1997, 10.2: the strategies with two vertices of the light's): where the lamp is near
// it is the lamp's ray, and where the two surfaces are near each other the path's own.
#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "reference/glass_light.h"
#include "reference/integrator.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr int most_passed = 256;

// Of the directions in which a lamp's rays leave, which are all alike: a spot's cone, else all; 1/sr.
double ray_density(const PunctualLight& light) {
  return light.type == LightType::spot ? 1 / (2 * pi * (1 - light.cos_outer)) : 1 / (4 * pi);
}
bool sends_rays(const PunctualLight& light, glm::dvec3 along) {
  return light.type != LightType::spot || glm::dot(along, light.direction) >= light.cos_outer;
}

struct LampRay {
  glm::dvec3 origin{0}, direction{0};
};
LampRay ray_of(const PunctualLight& light, glm::dvec2 u, glm::dvec2 on_sphere) {
  LampRay ray;
  const double height = light.type == LightType::spot ? 1 - light.cos_outer : 2, down = u.x * height;
  glm::dvec3 x, y;
  make_frame(light.direction, x, y);
  const double across = std::sqrt(std::max(down * (2 - down), 0.0)), turn = 2 * pi * u.y;
  ray.direction = glm::normalize(light.direction * (1 - down) + across * (std::cos(turn) * x + std::sin(turn) * y));
  ray.origin = light.position;
  if (light.radius_m > 0) {
    // From the half of the sphere that the direction sees, even over its disc.
    make_frame(ray.direction, x, y);
    const double r = std::sqrt(on_sphere.x), phi = 2 * pi * on_sphere.y;
    ray.origin += light.radius_m * (r * (std::cos(phi) * x + std::sin(phi) * y) +
                                    std::sqrt(std::max(1 - on_sphere.x, 0.0)) * ray.direction);
  }
  return ray;
}

// Of a place and, where the lamp has a size, of the direction of its light there: per square metre (and steradian).
double place_density(const PunctualLight& light, glm::dvec3 position, glm::dvec3 geometric, glm::dvec3 l) {
  if (!sends_rays(light, -l)) return 0;
  const double cosine = std::abs(glm::dot(geometric, l));
  const glm::dvec3 to_centre = light.position - position;
  const double d2 = glm::dot(to_centre, to_centre);
  if (light.radius_m > 0)
    return d2 > square(light.radius_m) ? ray_density(light) * cosine / (pi * square(light.radius_m)) : 0;
  return d2 > 0 ? ray_density(light) * cosine / d2 : 0;
}

}  // namespace

double Integrator::lamp_rays(const Departure& from, glm::dvec3 position, glm::dvec3 geometric, uint32_t lamp,
                             glm::dvec3 l) const {
  if (!from.joined || !(from.density > 0)) return 0;
  const PunctualLight& light = world_.punctual_lights()[world_.tree_punctual()[lamp]];
  const double places = place_density(light, position, geometric, l);
  if (!(places > 0)) return 0;
  const glm::dvec3 back = from.position - position;
  const double r2 = glm::dot(back, back), cosine_r = std::abs(glm::dot(geometric, back));
  const double chosen = world_.lamp_tree().probability(lamp, from.position, glm::dvec3(0), false);
  return chosen * places * r2 * std::sqrt(r2) / (from.density * cosine_r);
}

glm::dvec3 Integrator::by_lamp_rays(const Surface& s, const SurfacePoint& point, glm::dvec3 v,
                                    SampleStream stream) const {
  const glm::dvec3 none(0);
  const double which = stream.next();
  double cover = stream.next();
  const glm::dvec2 along = stream.next2(), on_sphere = stream.next2();
  static thread_local std::vector<LightTree::Choice> chosen;
  world_.lamp_tree().choose(s.position, glm::dvec3(0), which, false, chosen);
  if (chosen.empty()) return none;
  const LightTree::Choice choice = chosen[0];
  const PunctualLight& light = world_.punctual_lights()[world_.tree_punctual()[choice.light]];
  const LampRay lamp_ray = ray_of(light, along, on_sphere);
  const Ray ray = leaving_ray({glm::vec3(lamp_ray.origin), {}, 0}, lamp_ray.direction);
  std::optional<Hit> hit = next_surface(world_, ray, false, nullptr, nullptr, true, LightAlong::from_origin);
  // A blended surface is there as often as it covers.
  for (int passed = 0; hit && world_.is_blended(hit->item); ++passed) {
    const double coverage = world_.coverage(*hit);
    if (cover < coverage) break;
    if (passed == most_passed) return none;
    cover = std::min((cover - coverage) / (1 - coverage), 1 - 0x1p-53);
    const Hit before = *hit;
    hit = next_surface(world_, ray, false, &before, nullptr, true, LightAlong::from_origin);
  }
  if (!hit) return none;
  const Surface lit = world_.surface_from(*hit, lamp_ray.origin, lamp_ray.direction, s.position);
  if (lit.unlit) return none;
  const glm::dvec3 to_lit = lit.position - s.position;
  const double r2 = glm::dot(to_lit, to_lit), distance_m = std::sqrt(r2);
  if (!(r2 > 0)) return none;
  const glm::dvec3 l = to_lit / distance_m;
  if (!is_open(s, l)) return none;
  const glm::dvec3 f = evaluate_bsdf(s, l, v);
  if (f == none) return none;
  const bool sized = light.radius_m > 0;
  const glm::dvec3 l_lit = sized ? -lamp_ray.direction : glm::normalize(light.position - lit.position);
  const Arrival a = sized ? light_in(light, lit.position, l_lit).value_or(Arrival{}) : arriving(light, lit.position);
  if (a.illuminance == none || !is_open(lit, l_lit)) return none;
  const glm::dvec3 f_lit = evaluate_bsdf(lit, l_lit, -l, !sized);
  if (f_lit == none) return none;
  const double places = place_density(light, lit.position, lit.geometric, l_lit);
  const double facing = std::abs(glm::dot(lit.geometric, l)) / r2;
  const double own = choice.probability * places;
  if (!(own > 0) || !(facing > 0)) return none;
  // The other ways: the path's own bounce and then the lamp's choice, or for a lamp of a size the surface's.
  const double bounce = bsdf_pdf(s, l, v) * facing;
  const double by_choice =
      bounce * world_.light_tree().probability(choice.light, lit.position, lit_side(lit), true) * (sized ? a.pdf : 1);
  const double by_bsdf = sized ? bounce * bsdf_pdf(lit, l_lit, -l) : 0;
  const double w = 1 / (1 + square(by_choice / own) + square(by_bsdf / own));
  const glm::dvec3 light_at = a.illuminance * (sized ? a.pdf : 1);
  glm::dvec3 radiance = f * f_lit * light_at * (w * facing / own);
  radiance *= world_.through_fog(s.position, l, distance_m) * world_.through_fog(lit.position, l_lit, a.distance_m);
  if (radiance == none) return none;
  const SurfacePoint end = world_.point(*hit);
  return radiance * light_through(world_, point, l, distance_m, nullptr, &end, false, LightAlong::none);
}

}  // namespace candela::reference
