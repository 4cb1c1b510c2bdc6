#pragma once
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "scene/view_hulls.h"

namespace candela {

// Where a camera stands that sees a set of points as large as they go: centred between what touches the picture's
// edges, left and right as above and below.
struct Fit {
  glm::dvec3 position{0};  // world
  double nearest_m = 0;    // depth of the nearest point
  double half_height = 0;  // orthographic: half the height that is seen, metres
};
// axes: right, up and back of the camera. tan_x, tan_y: tangents of its half angles, of which `margin` (0.05: a
// twentieth) stays free on each side. At least one point. In closed form: the planes of two sides through the outermost
// points meet where the camera has to be.
Fit fit_perspective(std::span<const glm::dvec3> points, const glm::dmat3& axes, double tan_x, double tan_y,
                    double margin);
// The same of outlines, and as large as they go on both axes: what touches the picture's edges on the axis with more
// room is as far from the one edge as from the other.
Fit fit_perspective(ViewHulls& hulls, const glm::dmat3& axes, double tan_x, double tan_y, double margin);
Fit fit_orthographic(ViewHulls& hulls, const glm::dmat3& axes, double aspect, double margin);

// aspect: width over height.
Fit fit_orthographic(std::span<const glm::dvec3> points, const glm::dmat3& axes, double aspect, double margin);

std::vector<glm::dvec3> corners_of(const DAabb& box);
// What a box sweeps when it turns once about the upright axis through its centre, as points on two circles, the first
// of each in a camera's direction `right`, so that they look the same to cameras that stand around it.
std::vector<glm::dvec3> turned_once(const DAabb& box, glm::dvec3 right);

}  // namespace candela
