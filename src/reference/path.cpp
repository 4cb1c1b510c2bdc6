// Full transport of light: paths from the camera, a light chosen at every surface, and both ways of meeting a light weighted
// (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997).
#include <cmath>

#include "reference/integrator.h"
#include "reference/visibility.h"

namespace candela::reference {
namespace {

constexpr int roulette_after = 4;
constexpr int split_bounces = 1;  // surfaces at which more than one light is chosen: what the camera sees
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

std::optional<Integrator::EmissivePoint> Integrator::emissive_point(uint32_t light, double probability, glm::dvec3 from, glm::dvec2 u) const {
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
  const EmissiveTriangle& t = world_.emissive()[p.light];
  const Surface emitter = world_.surface_at(t.item, t.primitive, p.at, p.back, -p.l);
  return emitter.emission * emitter.coverage;
}

SurfacePoint Integrator::surface_of(const EmissivePoint& p) const {
  const EmissiveTriangle& t = world_.emissive()[p.light];
  return world_.accel().surface({0, float(p.at.x), float(p.at.y), t.item, t.primitive, p.back});
}

// The light of one triangle by way of one point on it.
glm::dvec3 Integrator::emissive_event(uint32_t light, double probability, const Surface& s, const SurfacePoint& point, glm::dvec3 v,
                                      glm::dvec2 u) const {
  const auto p = emissive_point(light, probability, s.position, u);
  if (!p || !(glm::dot(s.geometric, p->l) > 0)) return glm::dvec3(0);
  const glm::dvec3 f = evaluate_brdf(s, p->l, v);
  if (f == glm::dvec3(0)) return glm::dvec3(0);
  const glm::dvec3 radiance = radiance_of(*p) * f * (weight(p->pdf, brdf_pdf(s, p->l, v), Strategy::light) / p->pdf);
  if (radiance == glm::dvec3(0)) return radiance;
  const SurfacePoint end = surface_of(*p);
  return radiance * transmittance(world_, point, p->l, p->distance_m, &end) * world_.through_fog(s.position, p->l, p->distance_m);
}

glm::dvec2 Integrator::on_triangle(glm::dvec2 first, size_t light) {
  const glm::dvec2 turned = first + double(light) * glm::dvec2(0.7548776662466927, 0.5698402909980532);
  return turned - glm::floor(turned);
}

bool Integrator::survives(double u, int bounce, glm::dvec3& through) {
  if (bounce <= roulette_after) return true;
  const double survive = std::min(std::max({through.x, through.y, through.z}), 0.95);
  if (!(u < survive)) return false;
  through /= survive;
  return true;
}

// Every directional light, one direction of the sky, and lights of the tree.
glm::dvec3 Integrator::next_event(const Surface& s, const SurfacePoint& point, glm::dvec3 v, bool split, SampleStream& stream) const {
  glm::dvec3 sum(0);
  for (const uint32_t index : world_.directional()) sum += one_light(world_.punctual_lights()[index], s, point, v);
  const glm::dvec2 for_sky = stream.next2();
  if (world_.sky() && settings_.strategy != Strategy::brdf) {
    const Sky::Choice choice = world_.sky().sample(for_sky);
    const glm::dvec3 f = choice.pdf > 0 ? evaluate_brdf(s, choice.direction, v) : glm::dvec3(0);
    if (f != glm::dvec3(0)) {
      const double w = weight(choice.pdf, brdf_pdf(s, choice.direction, v), Strategy::light);
      const glm::dvec3 radiance = world_.sky().radiance(choice.direction) * f * (w / choice.pdf);
      if (radiance != glm::dvec3(0)) sum += radiance * sky_visibility(s, point, choice.direction);
    }
  }
  const double which = stream.next();
  stream.next();
  const glm::dvec2 on_light = stream.next2();
  static thread_local std::vector<LightTree::Choice> chosen;
  world_.light_tree().choose(s.position, s.normal, which, split, chosen);
  const size_t points = world_.tree_punctual().size();
  for (size_t i = 0; i < chosen.size(); ++i) {
    const LightTree::Choice& choice = chosen[i];
    if (choice.light < points) {
      sum += one_light(world_.punctual_lights()[world_.tree_punctual()[choice.light]], s, point, v) / choice.probability;
    } else if (settings_.strategy != Strategy::brdf) {
      sum += emissive_event(uint32_t(choice.light - points), choice.probability, s, point, v, on_triangle(on_light, i));
    }
  }
  return sum;
}

PixelSample Integrator::sample_path(const CameraRay& camera, SampleStream& stream) const {
  PixelSample out;
  glm::dvec3 through(1), origin = camera.origin, direction = camera.direction;
  Ray ray = rounded(camera);
  TraceCounts counts;
  std::optional<Hit> passed;
  // Of the bounce that the ray comes from; the camera's first ray meets lights by itself alone.
  double brdf_density = 0;
  glm::dvec3 last_normal(0), last_position(0);
  uint32_t alpha_dimension = first_alpha_dimension;
  int bounce = 0;
  bool in_fog = false;  // the camera's ray ended there
  for (int event = 0; event < most_events; ++event) {
    const bool first = bounce == 0;
    const std::optional<Hit> hit = next_surface(world_, ray, first, passed ? &*passed : nullptr, first ? &counts : nullptr);
    const Surface s = hit ? world_.surface(*hit, origin, direction) : Surface{};
    if (hit && s.coverage < 1) {
      // A blended surface is there as often as it covers.
      stream.start(alpha_dimension);
      alpha_dimension += 4;
      if (stream.next() >= s.coverage) {
        passed = *hit;
        continue;
      }
    }
    passed.reset();
    if (first) out.alpha = hit ? 1 : world_.background(direction).w;
    if (world_.medium()) {
      const glm::dvec3 onward = glm::normalize(direction);
      const FogStep step =
          fog_step(origin, onward, hit ? glm::dot(s.position - origin, onward) : endless, through, bounce, bounce < split_bounces, stream, out);
      through = step.through;
      if (through == glm::dvec3(0)) break;
      if (step.scattered) {
        in_fog |= first;
        ++bounce;
        brdf_density = step.density, last_normal = glm::dvec3(0), last_position = step.position;
        ray = leaving_ray({step.position, {}, 0}, step.direction);
        origin = step.position, direction = step.direction;
        continue;
      }
    }
    if (!hit) {
      if (first) {
        out.radiance += through * glm::dvec3(world_.background(direction));
      } else if (world_.sky()) {
        const double w = weight(brdf_density, world_.sky().pdf(direction), Strategy::brdf);
        out.radiance += through * world_.sky().radiance(direction) * w;
      }
      break;
    }
    if (s.unlit) {
      // A picture, not a lamp: it is seen, also in reflections, and takes no light and is not chosen as a light.
      out.radiance += through * s.base_color;
      break;
    }
    const glm::dvec3 v = -glm::normalize(direction);
    if (s.emission != glm::dvec3(0) && emits_towards(world_, *hit)) {
      double w = 1;
      const int light = first ? -1 : world_.emissive_of(hit->item, hit->primitive);
      if (light >= 0) {
        const EmissiveTriangle& t = world_.emissive()[size_t(light)];
        const glm::dvec3 d = s.position - last_position;
        const double probability =
            world_.light_tree().probability(uint32_t(world_.tree_punctual().size()) + uint32_t(light), last_position, last_normal, bounce - 1 < split_bounces);
        const double pdf = probability * glm::dot(d, d) / (std::abs(glm::dot(t.normal, v)) * t.area_m2);
        w = weight(brdf_density, pdf, Strategy::brdf);
      }
      out.radiance += through * s.emission * w;
    }
    if (settings_.most_bounces > 0 && bounce >= settings_.most_bounces) break;
    const SurfacePoint point = world_.accel().surface(*hit);
    stream.start(4 + uint32_t(bounce) * dimensions_a_bounce);
    const glm::dvec2 for_lobe = stream.next2();
    const double lobe = stream.next(), roulette = stream.next();
    out.radiance += through * next_event(s, point, v, bounce < split_bounces, stream);

    const glm::dvec3 l = sample_brdf(s, v, lobe, for_lobe);
    const double pdf = brdf_pdf(s, l, v);
    if (!(pdf > 0) || !(glm::dot(s.geometric, l) > 0)) break;
    through *= evaluate_brdf(s, l, v) / pdf;
    ++bounce;
    if (!survives(roulette, bounce, through) || through == glm::dvec3(0)) break;
    brdf_density = pdf, last_normal = s.normal, last_position = s.position;
    ray = leaving_ray(point, l);
    origin = ray.origin, direction = l;
  }
  if (in_fog) out.fog_light = out.radiance;
  out.traversal = 0.25 * double(counts.nodes) + double(counts.triangles);
  return out;
}

}  // namespace candela::reference
