#include "reference/centre_surface.h"

#include "reference/visibility.h"

namespace candela::reference {

std::optional<Hit> nearest_surface(const World& world, const CameraRay& camera) {
  const Ray ray = rounded(camera);
  std::optional<Hit> hit = next_surface(world, ray, true, nullptr, nullptr);
  while (hit && world.is_blended(hit->item)) {
    const Hit passed = *hit;
    hit = next_surface(world, ray, true, &passed, nullptr);
  }
  return hit;
}

std::optional<CentreSurface> centre_surface(const World& world, int x, int y, int width_px, int height_px) {
  const CameraRay camera = world.camera_ray(glm::dvec2(x, y) + 0.5, width_px, height_px);
  const std::optional<Hit> hit = nearest_surface(world, camera);
  if (!hit) return std::nullopt;
  CentreSurface out;
  out.item = hit->item;
  out.primitive = hit->primitive;
  if (!world.accel().implicit(hit->item)) out.weights = world.weights(*hit, camera.origin, camera.direction);
  out.surface = world.surface(*hit, camera.origin, camera.direction);
  // The direction is of length 1 along the axis, and so is the origin off it: both for perspective and orthographic
  // views.
  const glm::dvec3 back = glm::transpose(glm::dmat3(world.view().view_from_relative))[2];
  out.depth_m = -glm::dot(out.surface.position, back);
  return out;
}

}  // namespace candela::reference
