#include "reference/glass_light.h"

namespace candela::reference {

glm::dvec3 light_through(const World& world, const SurfacePoint& from, glm::dvec3 l, double distance_m,
                         const Interior* start, const SurfacePoint* target, bool to_lamp, LightAlong light) {
  if (!world.has_glass()) return glm::dvec3(transmittance(world, from, l, distance_m, target, to_lamp, light));
  const std::optional<Ray> ray = shadow_ray(from, l, distance_m, target);
  if (!ray) return glm::dvec3(1);
  const glm::dvec3 origin(ray->origin), direction(ray->direction);
  const double per_t = glm::length(direction);
  GlassWay way = start ? GlassWay(*start) : GlassWay();
  glm::dvec3 through(1);
  std::optional<Hit> hit = next_surface(world, *ray, false, nullptr, nullptr, to_lamp, light);
  while (hit) {
    Surface s = world.surface(*hit, origin, direction);
    through *= way.arrive(s, -l, hit->back, double(hit->t) * per_t);
    through *= (1 - s.coverage) + s.coverage * straight_share(s, -l);
    if (through == glm::dvec3(0)) return through;
    if (is_straight(s)) way.cross();
    const Hit passed = *hit;
    hit = next_surface(world, *ray, false, &passed, nullptr, to_lamp, light);
  }
  return through * way.end(distance_m);
}

}  // namespace candela::reference
