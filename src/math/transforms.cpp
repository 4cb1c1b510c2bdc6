#include "math/transforms.h"

namespace candela {
glm::dmat4 look_at_pose(glm::dvec3 eye, glm::dvec3 target) {
  glm::dvec3 back = eye - target;
  const double length = glm::length(back);
  back = length > 0 ? back / length : glm::dvec3(0, 0, 1);
  glm::dvec3 up(0, 1, 0);
  if (std::abs(back.y) > 1 - 1e-9) up = glm::dvec3(0, 0, back.y > 0 ? -1 : 1);
  const glm::dvec3 right = glm::normalize(glm::cross(up, back));
  glm::dmat4 m(1.0);
  m[0] = glm::dvec4(right, 0);
  m[1] = glm::dvec4(glm::cross(back, right), 0);
  m[2] = glm::dvec4(back, 0);
  m[3] = glm::dvec4(eye, 1);
  return m;
}
}  // namespace candela
