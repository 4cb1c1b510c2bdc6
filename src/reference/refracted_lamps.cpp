// Light of lamps without a size by way of bodies of smooth glass.
//
// Neither a path nor a shadow ray finds it: no direction that glass mirrors or refracts meets a point but by chance of
// measure 0. So the direction is solved for: from a place in the direction w the ray goes through the bodies and passes
// the lamp at a distance; Newton's method brings that to 0, with the exact derivatives of the ray (Igehy 1999). It is
// the way of "Manifold Next Event Estimation" (Hanika, Droske, Fascione 2015) with the direction for the unknown, so
// that every step is a way of light, through as many walls as lie on it. The light that arrives is the lamp's
// intensity, what the walls leave, and |dw / dA|: the solid angle at the place over the area about the lamp.
//
// There may be many ways. One is looked for from the straight direction, and counts always. Others begin at a random
// place of the bodies' walls; such a way is found with a probability that is not known, whose inverse is the mean
// number of trials until it is found again (Zeltner, Georgiev, Jakob, "Specular Manifold Sampling for Rendering
// High-Frequency Caustics and Glints", 2020). Trials end after most_trials: ways that are found more seldom than that
// come out too dark. Followed are refraction, and reflection where it is total.
#include <cmath>

#include "math/transforms.h"
#include "reference/glass_light.h"
#include "reference/integrator.h"
#include "reference/ray_differential.h"

namespace candela::reference {
namespace {

constexpr int most_walls = 16, most_steps = 24, most_halvings = 8, most_trials = 1024;
constexpr double close = 1e-10;        // of the lamp's distance: a way is found
constexpr double same_way_rad = 1e-4;  // through the same triangles

class BodyWalls final : public HitFilter {
 public:
  explicit BodyWalls(const World& world) : world_(world), all_(world, false) {}
  bool accepts(const Hit& hit) const override { return world_.bounds_body(hit.item) && all_.accepts(hit); }

 private:
  const World& world_;
  SurfaceFilter all_;
};

// From one wall to the next; the last to the lamp.
struct Part {
  SurfacePoint from;
  glm::dvec3 origin{0}, onward{0};  // unit
  double length_m = 0;              // infinity to a directional light
  Interior about;
  uint32_t item = 0, primitive = 0;  // of the wall at the end
};
struct Way {
  std::array<Part, most_walls + 1> part;
  int walls = 0;
  glm::dvec3 weight{1};
  glm::dvec2 miss{0};    // by which it passes the lamp: in metres, of a directional light in radians
  glm::dmat2 change{0};  // of it, with the steps of the first direction along `aside`; sign turned
  glm::dvec3 aside[2] = {};
  double allowed = 0;  // length of `miss` at which it is found
  double length_m = 0;
  glm::dvec3 onward() const { return part[0].onward; }
};

// Where a way begins, and what it looks for.
struct Task {
  const World& world;
  glm::dvec3 position;
  SurfacePoint point;
  const Interior* before;
  const Interior* behind;
  glm::dvec3 geometric;
  const PunctualLight& light;
  double channel;  // a number in [0, 1) that chooses a colour where the glass splits them
  bool is_sun() const { return light.type == LightType::directional; }
};

bool follow(const Task& task, glm::dvec3 onward, Way& way) {
  const BodyWalls filter(task.world);
  way.walls = 0, way.weight = glm::dvec3(1), way.length_m = 0;
  make_frame(onward, way.aside[0], way.aside[1]);
  RayDifferential change;
  change.direction[0] = way.aside[0], change.direction[1] = way.aside[1];
  const Interior* start = glm::dot(task.geometric, onward) > 0 ? task.before : task.behind;
  GlassWay bodies = start ? GlassWay(*start) : GlassWay();
  Interior about = start ? *start : Interior();
  SurfacePoint from = task.point;
  glm::dvec3 origin = task.position;
  for (;;) {
    Part& part = way.part[size_t(way.walls)];
    part.from = from, part.origin = origin, part.onward = onward, part.about = about;
    const Ray ray = leaving_ray(from, onward);
    const std::optional<Hit> hit = task.world.accel().closest(ray, &filter);
    const double lamp_m = task.is_sun() ? endless : glm::dot(task.light.position - origin, onward);
    Surface s;
    double wall_m = endless;
    if (hit) {
      s = task.world.surface(*hit, origin, onward);
      wall_m = glm::dot(s.position - origin, onward);
    }
    if (lamp_m < wall_m || !hit) {
      part.length_m = lamp_m;
      break;
    }
    if (way.walls == most_walls || !(wall_m > 0)) return false;
    part.length_m = wall_m, part.item = hit->item, part.primitive = hit->primitive;
    way.length_m += wall_m;
    if (task.world.accel().implicit(hit->item)) return false;  // ways are sought by triangles
    const glm::dvec3 v = -onward, shaded = s.normal;
    if (bodies.splits(s)) way.weight *= bodies.choose_channel(s, task.channel);
    bodies.arrive(s, v, hit->back, wall_m);
    const std::optional<Bend> bend = bent(s, v);
    if (!bend || bend->weight == glm::dvec3(0)) return false;
    way.weight *= bend->weight * s.coverage;
    change.go(onward, wall_m, s.geometric);
    glm::dvec3 turn[2] = {};
    if (bend->facet == shaded) {
      const PosedTriangle triangle = task.world.accel().triangle(hit->item, hit->primitive);
      const glm::dvec3 p0(triangle.position[0]), edge1 = glm::dvec3(triangle.position[1]) - p0,
                                                 edge2 = glm::dvec3(triangle.position[2]) - p0;
      const auto by_weight = task.world.turn(*hit, task.world.weights(*hit, origin, onward), v);
      for (int i = 0; i < 2; ++i) {
        const glm::dvec2 step = weights_of_step(edge1, edge2, change.place[i]);
        turn[i] = step.x * by_weight[0] + step.y * by_weight[1];
      }
    }
    if (bend->through)
      change.refract(v, bend->facet, turn, s.eta);
    else
      change.reflect(v, bend->facet, turn);
    about = bend->through ? *s.behind : *s.before;
    if (bend->through) bodies.cross();
    bodies.start_ray();
    from = task.world.point(*hit), origin = s.position, onward = glm::normalize(bend->l);
    ++way.walls;
  }
  glm::dvec3 x, y, off;
  make_frame(onward, x, y);
  if (task.is_sun()) {
    off = -task.light.direction;
    if (!(glm::dot(off, onward) > 0)) return false;
    way.allowed = close;
    for (int i = 0; i < 2; ++i) change.place[i] = change.direction[i];
  } else {
    const double lamp_m = way.part[size_t(way.walls)].length_m;
    if (!(lamp_m > 0)) return false;
    off = task.light.position - origin;
    way.length_m += lamp_m;
    way.allowed = close * way.length_m;
    for (int i = 0; i < 2; ++i) change.place[i] += lamp_m * change.direction[i];
  }
  way.miss = {glm::dot(off, x), glm::dot(off, y)};
  for (int i = 0; i < 2; ++i) way.change[i] = {glm::dot(change.place[i], x), glm::dot(change.place[i], y)};
  return way.walls > 0 && std::isfinite(way.miss.x + way.miss.y) && std::isfinite(glm::determinant(way.change));
}

// The way of light that Newton's method comes to from a direction.
bool solve(const Task& task, glm::dvec3 onward, Way& way) {
  if (!follow(task, onward, way)) return false;
  Way next;
  for (int step = 0; step < most_steps; ++step) {
    const double miss = glm::length(way.miss);
    if (miss <= way.allowed) return glm::determinant(way.change) != 0;
    glm::dvec2 by = glm::inverse(way.change) * way.miss;
    const double size = glm::length(by);
    if (!std::isfinite(size)) return false;
    if (size > 1) by /= size;
    bool nearer = false;
    for (int halving = 0; halving < most_halvings && !nearer; ++halving, by *= 0.5)
      nearer = follow(task, glm::normalize(way.onward() + by.x * way.aside[0] + by.y * way.aside[1]), next) &&
               glm::length(next.miss) < miss;
    if (!nearer) return false;
    way = next;
  }
  return false;
}

bool is_same(const Way& a, const Way& b) {
  if (a.walls != b.walls || glm::distance(a.onward(), b.onward()) > same_way_rad) return false;
  for (int i = 0; i < a.walls; ++i)
    if (a.part[size_t(i)].item != b.part[size_t(i)].item || a.part[size_t(i)].primitive != b.part[size_t(i)].primitive)
      return false;
  return true;
}

// What lies in the way leaves of the light.
glm::dvec3 left_of(const Task& task, const Way& way) {
  glm::dvec3 left(1);
  for (int i = 0; i <= way.walls && left != glm::dvec3(0); ++i) {
    const Part& part = way.part[size_t(i)];
    const SurfacePoint* end = i < way.walls ? &way.part[size_t(i) + 1].from : nullptr;
    const bool to_lamp = !end && !task.is_sun();
    left *= light_through(task.world, part.from, part.onward, part.length_m, &part.about, end, to_lamp);
    if (part.about.empty()) left *= task.world.through_fog(part.origin, part.onward, part.length_m);
  }
  return left;
}

// What the light of intensity sends along the way, as the illuminance of a surface that faces its end: cd / m^2 of the
// solved area, or lux.
glm::dvec3 sent(const Task& task, const Way& way) {
  if (task.is_sun()) return task.light.intensity;
  // As far away as the light has come; a metre off for its intensity.
  const glm::dvec3 onward = way.part[size_t(way.walls)].onward;
  const glm::dvec3 there = task.light.position - onward * way.length_m;
  return arriving(task.light, there).illuminance * square(std::max(way.length_m, task.light.least_m));
}

}  // namespace

glm::dvec3 Integrator::through_bodies(const PunctualLight& light, const Receiver& r, int most_walls_left,
                                      SampleStream stream) const {
  const glm::dvec3 none(0);
  if (light.has_size()) return none;
  const Task task{world_, r.position, r.point, r.before, r.behind, r.normal, light, stream.next()};
  stream.next();
  const auto light_of = [&](const Way& way) {
    if (way.walls > most_walls_left) return none;
    const glm::dvec3 f = r.turns(way.onward());
    if (f == none) return none;
    const glm::dvec3 radiance = f * way.weight * sent(task, way) / std::abs(glm::determinant(way.change));
    return radiance == none ? none : radiance * left_of(task, way);
  };
  static thread_local Way straight, first, again;
  const glm::dvec3 to_light = task.is_sun() ? -light.direction : light.position - r.position;
  const bool has_straight = glm::dot(to_light, to_light) > 0 && solve(task, glm::normalize(to_light), straight);
  glm::dvec3 sum = has_straight ? light_of(straight) : none;
  const auto draw = [&](Way& way) {
    stream.next();
    const double which = stream.next();
    const glm::dvec3 to = world_.bending_place(which, stream.next2()) - r.position;
    return glm::dot(to, to) > 0 && solve(task, glm::normalize(to), way);
  };
  if (!draw(first) || (has_straight && is_same(first, straight))) return sum;
  const glm::dvec3 radiance = light_of(first);
  if (radiance == none) return sum;
  int trials = 1;
  while (trials < most_trials && !(draw(again) && is_same(again, first))) ++trials;
  return sum + double(trials) * radiance;
}

glm::dvec3 Integrator::by_bodies(const Surface& s, const SurfacePoint& point, glm::dvec3 v, int bounce,
                                 SampleStream stream) const {
  if (s.glass && s.transmission == 1 && s.roughness < least_roughness && !s.lobes) return {};  // shows no lamp
  return by_bodies({s.position, point, s.before, s.behind, s.geometric,
                    [&](glm::dvec3 l) { return is_open(s, l) ? evaluate_bsdf(s, l, v) : glm::dvec3(0); }},
                   bounce, stream);
}

glm::dvec3 Integrator::by_bodies(const Receiver& receiver, int bounce, SampleStream stream) const {
  glm::dvec3 sum(0);
  const int walls = settings_.most_bounces > 0 ? settings_.most_bounces - bounce - 1 : most_walls;
  if (walls < 1) return sum;
  constexpr uint32_t dimensions_a_light = 4 * (most_trials + 2);
  const double pick = stream.next(), which = stream.next();
  stream.next(), stream.next();
  for (size_t i = 0; i < world_.directional().size(); ++i)
    sum += through_bodies(world_.punctual_lights()[world_.directional()[i]], receiver, walls,
                          stream.apart(uint32_t(i + 1) * dimensions_a_light));
  if (world_.lamp_tree().empty()) return sum;
  // Half by what they would give unhindered, half by their power: glass may bring light to where a lamp shines none.
  static thread_local std::vector<LightTree::Choice> chosen;
  chosen.clear();
  if (pick < 0.5) world_.lamp_tree().choose(receiver.position, glm::dvec3(0), which, false, chosen);
  if (pick < 0.5 && chosen.empty()) return sum;
  const uint32_t lamp = pick < 0.5 ? chosen[0].light : world_.lamp_by_power(which);
  const double probability =
      (world_.lamp_tree().probability(lamp, receiver.position, glm::dvec3(0), false) + world_.lamp_power_share(lamp)) /
      2;
  const glm::dvec3 light =
      through_bodies(world_.punctual_lights()[world_.tree_punctual()[lamp]], receiver, walls, stream);
  return probability > 0 ? sum + light / probability : sum;
}

}  // namespace candela::reference
