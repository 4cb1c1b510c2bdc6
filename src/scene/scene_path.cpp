#include "scene/scene_path.h"

#include <cmath>

namespace candela {
namespace {

// Right, up and the axis z of what looks that way; up as near to `up` as can be, and where both are one line near to
// any axis.
glm::dmat3 axes_of(glm::dvec3 z, glm::dvec3 up) {
  glm::dvec3 x = glm::cross(glm::normalize(up), z);
  if (!(glm::length(x) > 1e-9)) {
    const glm::dvec3 a = glm::abs(z);
    x = glm::cross(a.z <= a.x && a.z <= a.y ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0), z);
  }
  x = glm::normalize(x);
  return {x, glm::cross(z, x), z};
}

// 0: nothing to look at.
glm::dvec3 looking(const ScenePath& path, const PathPlace& place, const glm::dmat3& parent, glm::dvec3 from,
                   const std::vector<glm::dmat4>& before) {
  glm::dvec3 to(0);
  if (path.looks == ScenePath::Looks::along)
    to = path.in_world ? place.direction : parent * place.direction;
  else if (path.looks == ScenePath::Looks::at_point)
    to = path.point - from;
  else if (path.looks == ScenePath::Looks::at_node && !before.empty())
    to = glm::dvec3(before[size_t(path.looked_at)][3]) - from;
  const double length = glm::length(to);
  return length > 0 && std::isfinite(length) ? to / length : glm::dvec3(0);
}

}  // namespace

PathPlace ScenePath::at(double time_s) const {
  double u = times.at(time_s);
  if (length) u = length->evenly(u);
  return {spline.at(u), looks == Looks::along ? spline.direction(u) : glm::dvec3(0)};
}

glm::dmat4 on_path(const ScenePath& path, const PathPlace& place, const glm::dmat4& parent, const glm::dmat4& local,
                   const std::vector<glm::dmat4>& before) {
  glm::dmat4 moved = local;
  moved[3] = glm::dvec4(place.position, 1);
  glm::dmat4 world = parent * moved;
  if (path.in_world) world[3] = glm::dvec4(place.position, 1);
  const glm::dvec3 way = looking(path, place, glm::dmat3(parent), glm::dvec3(world[3]), before);
  if (way == glm::dvec3(0)) return world;
  const glm::dmat3 axes = axes_of(path.front * way, path.up);
  const double side = glm::determinant(glm::dmat3(world)) < 0 ? -1 : 1;  // what was mirrored stays so
  for (int c = 0; c < 3; ++c) {
    const double length = glm::length(glm::dvec3(world[c]));
    world[c] = glm::dvec4(axes[c] * length * (c == 0 ? side : 1.0), 0);
  }
  return world;
}

}  // namespace candela
