#pragma once
#include <glm/glm.hpp>

namespace candela::reference {

// How a ray's place and unit direction change with two numbers that it depends on, as it goes from surface to surface
// (Igehy, "Tracing Ray Differentials", 1999). Exact derivatives of the way through one row of triangles.
struct RayDifferential {
  glm::dvec3 place[2] = {}, direction[2] = {};

  // On to a plane of unit normal `plane`, `distance` away along unit direction `onward`.
  void go(glm::dvec3 onward, double distance, glm::dvec3 plane);
  // At a mirror of unit normal h, whose change along the surface is `turn`; v: back along the ray.
  void reflect(glm::dvec3 v, glm::dvec3 h, const glm::dvec3 turn[2]);
  // At an interface; eta: index of refraction behind it over the one before.
  void refract(glm::dvec3 v, glm::dvec3 h, const glm::dvec3 turn[2], double eta);
};

// Weights of the second and third corner of a triangle, by which a step in its plane changes them; 0 of a triangle
// without an area. edge1, edge2: from the first corner.
glm::dvec2 weights_of_step(glm::dvec3 edge1, glm::dvec3 edge2, glm::dvec3 step);

}  // namespace candela::reference
