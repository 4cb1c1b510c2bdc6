#include "reference/visibility.h"

#include <cmath>
#include <limits>
#include <tuple>

namespace candela::reference {
namespace {
// The end of a shadow ray is kept off what it is aimed at by some units in the last place of a float.
constexpr float before_end = 1 - 4e-6f;

// A ray along the edge that two triangles of an item share meets both, and covers it but once. (The centres of pixels
// lie on the diagonals of squares often.)
bool is_on_edge(const Hit& h) { return std::min({h.u, h.v, 1 - h.u - h.v}) < 1e-5f; }
bool is_same_point(const Hit& a, const Hit& b) {
  return a.item == b.item && a.primitive != b.primitive && std::abs(a.t - b.t) <= 4e-6f * std::abs(b.t) &&
         is_on_edge(a) && is_on_edge(b);
}
}  // namespace

bool passes_light(const World& world, const Hit& hit, LightAlong light) {
  if (light == LightAlong::none || !world.opens_sides() || hit.back != (light == LightAlong::from_origin)) return false;
  return !world.is_double_sided(hit.item) && !world.bounds_body(hit.item);
}

void SurfaceFilter::begin(const Ray& ray, bool any) {
  ray_ = &ray, any_ = any;
  relief_ = world_.leave_relief(ray);
  if (relief_ && !counts(*relief_)) relief_.reset();
}

std::optional<Hit> SurfaceFilter::closest(const Ray& ray, TraceCounts* trace_counts) {
  if (!world_.has_relief()) return world_.accel().closest(ray, this, trace_counts);
  begin(ray, false);
  const std::optional<Hit> hit = world_.accel().closest(ray, this, trace_counts);
  if (!relief_ || (hit && hit->t <= relief_->t)) return hit;
  return relief_;
}

bool SurfaceFilter::occluded(const Ray& ray) {
  if (!world_.has_relief()) return world_.accel().occluded(ray, this);
  begin(ray, true);
  return relief_ || world_.accel().occluded(ray, this);
}

bool SurfaceFilter::accepts(const Hit& hit) const {
  if (!ray_ || !world_.has_relief(hit.item)) return counts(hit);
  if (culls_backs_ && hit.back && !world_.is_double_sided(hit.item)) return false;
  const std::optional<Hit> met = world_.meet_relief(*ray_, hit);
  if (!met || !counts(*met)) return false;
  if (!relief_ || std::tie(met->t, met->item, met->primitive) < std::tie(relief_->t, relief_->item, relief_->primitive))
    relief_ = met;
  // The nearest lies elsewhere than the tree has it, so that the tree goes on without it.
  return any_;
}

bool SurfaceFilter::counts(const Hit& hit) const {
  if (passed_ && (std::tie(hit.t, hit.item, hit.primitive) <= std::tie(passed_->t, passed_->item, passed_->primitive) ||
                  is_same_point(hit, *passed_)))
    return false;
  if (to_lamp_ && world_.glows_all_over(hit.item)) return false;
  if (culls_backs_ && hit.back && !world_.is_double_sided(hit.item) && !world_.bounds_body(hit.item)) return false;
  if (passes_light(world_, hit, light_)) return false;
  return !world_.is_masked(hit.item) || world_.coverage(hit) > 0;
}

std::optional<Hit> next_surface(const World& world, const Ray& ray, bool culls_backs, const Hit* passed,
                                TraceCounts* counts, bool to_lamp, LightAlong light) {
  SurfaceFilter filter(world, culls_backs, passed, to_lamp, light);
  Ray rest = ray;
  // A relief's triangle may lie before what was passed.
  if (passed && !world.has_relief()) rest.t_min = passed->t;
  return filter.closest(rest, counts);
}

std::optional<Ray> shadow_ray(const SurfacePoint& from, glm::dvec3 l, double distance_m, const SurfacePoint* target) {
  Ray ray = leaving_ray(from, l);
  if (std::isfinite(distance_m)) {
    // From the point where the ray really begins to the one where it ends, both pushed off their surfaces.
    const glm::vec3 end =
        target ? leaving_origin(*target, glm::vec3(-l)) : glm::vec3(glm::dvec3(from.position) + l * distance_m);
    ray.direction = end - ray.origin;
    ray.t_max = before_end;
    if (glm::dot(glm::dvec3(ray.direction), l) <= 0) return {};
  }
  return ray;
}

double transmittance(const World& world, const SurfacePoint& from, glm::dvec3 l, double distance_m,
                     const SurfacePoint* target, bool to_lamp, LightAlong light) {
  const std::optional<Ray> ray = shadow_ray(from, l, distance_m, target);
  if (!ray) return 1;
  if (!world.has_blend()) {
    SurfaceFilter filter(world, false, nullptr, to_lamp, light);
    return filter.occluded(*ray) ? 0 : 1;
  }
  double through = 1;
  std::optional<Hit> hit = next_surface(world, *ray, false, nullptr, nullptr, to_lamp, light);
  while (hit) {
    const double coverage = world.is_blended(hit->item) ? world.coverage(*hit) : 1;
    through *= 1 - coverage;
    if (!(through > 0)) return 0;
    const Hit passed = *hit;
    hit = next_surface(world, *ray, false, &passed, nullptr, to_lamp, light);
  }
  return through;
}

double near_visibility(const World& world, const SurfacePoint& from, glm::dvec3 l, const Occlusion& occlusion) {
  Ray ray = leaving_ray(from, l);
  ray.t_max = float(std::min(occlusion.radius_m, double(std::numeric_limits<float>::max())));
  double through = 1;
  std::optional<Hit> hit = next_surface(world, ray, false, nullptr, nullptr, false, LightAlong::to_origin);
  while (hit) {
    const double coverage = world.is_blended(hit->item) ? world.coverage(*hit) : 1;
    through *= 1 - coverage * occlusion.hidden(double(hit->t));
    if (!(coverage < 1)) return through;
    const Hit passed = *hit;
    hit = next_surface(world, ray, false, &passed, nullptr, false, LightAlong::to_origin);
  }
  return through;
}

Ray rounded(const CameraRay& ray) {
  Ray out;
  out.origin = ray.origin;
  out.direction = ray.direction;
  out.t_min = float(ray.t_min);
  out.t_max = float(ray.t_max);
  return out;
}

Ray leaving_ray(const SurfacePoint& from, glm::dvec3 direction) {
  Ray out;
  out.direction = direction;
  out.origin = leaving_origin(from, out.direction);
  out.relief_item = from.relief_item, out.relief_primitive = from.relief_primitive;
  return out;
}

}  // namespace candela::reference
