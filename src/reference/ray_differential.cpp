#include "reference/ray_differential.h"

#include <cmath>

namespace candela::reference {

void RayDifferential::go(glm::dvec3 onward, double distance, glm::dvec3 plane) {
  const double facing = glm::dot(onward, plane);
  for (int i = 0; i < 2; ++i) {
    const glm::dvec3 beside = place[i] + distance * direction[i];
    place[i] = beside - onward * (glm::dot(beside, plane) / facing);
  }
}

void RayDifferential::reflect(glm::dvec3 v, glm::dvec3 h, const glm::dvec3 turn[2]) {
  const double cosine = glm::dot(v, h);
  for (int i = 0; i < 2; ++i) {
    const double change = glm::dot(v, turn[i]) - glm::dot(direction[i], h);
    direction[i] = 2.0 * (change * h + cosine * turn[i]) + direction[i];
  }
}

void RayDifferential::refract(glm::dvec3 v, glm::dvec3 h, const glm::dvec3 turn[2], double eta) {
  const double cosine = glm::dot(v, h);
  const glm::dvec3 across = (cosine * h - v) / eta;
  const double inward = std::sqrt(std::max(1 - glm::dot(across, across), 0.0));
  for (int i = 0; i < 2; ++i) {
    const double change = glm::dot(v, turn[i]) - glm::dot(direction[i], h);
    const glm::dvec3 across_change = (change * h + cosine * turn[i] + direction[i]) / eta;
    direction[i] = across_change + h * (glm::dot(across, across_change) / inward) - inward * turn[i];
  }
}

glm::dvec2 weights_of_step(glm::dvec3 edge1, glm::dvec3 edge2, glm::dvec3 step) {
  const double a = glm::dot(edge1, edge1), b = glm::dot(edge1, edge2), c = glm::dot(edge2, edge2);
  const double determinant = a * c - b * b, x = glm::dot(edge1, step), y = glm::dot(edge2, step);
  if (!(determinant > 0)) return glm::dvec2(0);
  return {(c * x - b * y) / determinant, (a * y - b * x) / determinant};
}

}  // namespace candela::reference
