#pragma once
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "scene/metaballs.h"

namespace candela {

// A body of metaballs as the surface that it is, F = 0, in double. Rays meet it where their polynomials have roots:
// between the points where a ray enters or leaves supports of kernels, F is one of degree 6 along it, whose first root
// is found without a step size (subdivision of its Bezier form; Sederberg and Nishita, "Curve intersection using Bezier
// clipping", 1990, use the same hull).
class MetaballSurface {
 public:
  explicit MetaballSurface(const PosedMetaballs& body);

  // In order, where origin + t direction with t > 0 (relative space) goes in or out; until `found` returns true.
  using Crossing = std::function<bool(double t, bool goes_in)>;
  bool each_crossing(glm::dvec3 origin, glm::dvec3 direction, const Crossing& found) const;
  // The same place on the surface, along the ray from near it; where that fails, as it was.
  glm::dvec3 polished(glm::dvec3 near, glm::dvec3 direction) const;

  // Spheres of relative space, centre and radius, that hold the surface together; none about what reaches nowhere.
  std::vector<glm::dvec4> spheres() const;

  // Unit vectors of relative space that point outwards: of the surface, and as it is shaded, turned by noise. The first
  // is 0 where F has no slope.
  glm::dvec3 geometric_normal(glm::dvec3 relative) const;
  glm::dvec3 shading_normal(glm::dvec3 relative) const;

  // Where a point of this surface was at another time, in that one's relative space: moved and scaled with the balls
  // near it, by their kernels there, then along F's slope to where F has the same value.
  glm::dvec3 place_at(const MetaballSurface& then, glm::dvec3 relative) const;

 private:
  double field(glm::dvec3 p) const;  // of the node's space, like all below
  glm::dvec3 slope(glm::dvec3 p) const;
  glm::dvec3 outwards(glm::dvec3 p) const;
  glm::dvec3 in_node(glm::dvec3 relative) const { return glm::dvec3(node_from_relative_ * glm::dvec4(relative, 1.0)); }

  const PosedMetaballs body_;
  glm::dmat4 node_from_relative_;
};

}  // namespace candela
