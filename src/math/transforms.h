#pragma once
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

// Spaces: local (mesh) -> world (double) -> relative (world axes, origin at the camera, float) -> view (looks down -Z,
// +Y up)
// -> clip (Vulkan: y down, depth reversed). A matrix is named target_from_source.
namespace candela {

// Reversed, infinite projection: depth = near/z, 1 at the near plane, 0 at infinity (Reed 2015, "Depth Precision
// Visualized"). tan_x, tan_y: tangents of the half angles. Vulkan clip space, y down.
inline glm::dmat4 perspective_reversed_infinite(double tan_x, double tan_y, double near_m) {
  glm::dmat4 m(0.0);
  m[0][0] = 1.0 / tan_x;
  m[1][1] = -1.0 / tan_y;
  m[2][3] = -1.0;
  m[3][2] = near_m;
  return m;
}

// Reversed orthographic: depth = (far - z)/(far - near). half_width, half_height in metres; far must be finite.
inline glm::dmat4 orthographic_reversed(double half_width_m, double half_height_m, double near_m, double far_m) {
  glm::dmat4 m(0.0);
  m[0][0] = 1.0 / half_width_m;
  m[1][1] = -1.0 / half_height_m;
  m[2][2] = 1.0 / (far_m - near_m);
  m[3][2] = far_m / (far_m - near_m);
  m[3][3] = 1.0;
  return m;
}

inline glm::dmat4 compose_trs(glm::dvec3 translation, glm::dquat rotation, glm::dvec3 scale) {
  glm::dmat4 m = glm::mat4_cast(rotation);
  m[0] *= scale.x;
  m[1] *= scale.y;
  m[2] *= scale.z;
  m[3] = glm::dvec4(translation, 1.0);
  return m;
}

// world -> relative: the subtraction happens in double, then everything casts to float.
inline glm::dmat4 relative_from_world(glm::dvec3 camera_position) {
  glm::dmat4 m(1.0);
  m[3] = glm::dvec4(-camera_position, 1.0);
  return m;
}

// World pose of a camera at eye that looks at target; +Y up, or +Z where the view is along Y.
glm::dmat4 look_at_pose(glm::dvec3 eye, glm::dvec3 target);

inline double square(double x) { return x * x; }

}  // namespace candela
