#include "scene/fit_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/check.h"

namespace candela {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

glm::dvec3 mean_of(std::span<const glm::dvec3> points) {
  glm::dvec3 least(infinity), most(-infinity);
  for (const glm::dvec3& p : points) least = glm::min(least, p), most = glm::max(most, p);
  return least + (most - least) / 2.0;
}

}  // namespace

Fit fit_perspective(std::span<const glm::dvec3> points, const glm::dmat3& axes, double tan_x, double tan_y,
                    double margin) {
  CHECK(!points.empty() && tan_x > 0 && tan_y > 0 && margin >= 0 && margin < 1);
  // About their middle, so that far worlds keep their digits.
  const glm::dvec3 middle = mean_of(points);
  const glm::dvec2 tangent = glm::dvec2(tan_x, tan_y) * (1 - margin);
  // A point is in the picture where |x - cx| <= tangent * (d - z): d >= (x - cx) / tangent + z and the same to the
  // left.
  glm::dvec2 right(-infinity), left(-infinity);
  double front = -infinity, radius = 0;
  for (const glm::dvec3& point : points) {
    const glm::dvec3 p = glm::transpose(axes) * (point - middle);
    right = glm::max(right, glm::dvec2(p) / tangent + p.z);
    left = glm::max(left, -glm::dvec2(p) / tangent + p.z);
    front = std::max(front, p.z);
    radius = std::max(radius, glm::length(p));
  }
  const glm::dvec2 shift = tangent * (right - left) / 2.0, distance = (right + left) / 2.0;
  // What is flat and seen edge-on takes no room: it stays a little before the camera.
  const double d = std::max({distance.x, distance.y, front + 0.002 * radius});
  return {.position = middle + axes * glm::dvec3(shift, d), .nearest_m = d - front};
}

namespace {

struct Extent {
  double least = infinity, most = -infinity;
  double half() const { return (most - least) / 2; }
};
// Of coordinate 0 (across) or 1 (towards the camera).
Extent extent_of(std::span<const glm::dvec2> points, int k) {
  Extent e;
  for (const glm::dvec2& p : points) e.least = std::min(e.least, p[k]), e.most = std::max(e.most, p[k]);
  return e;
}

// The nearest apex from which all points lie within the two planes of an axis.
struct Apex {
  double across, distance;
};
Apex apex_of(std::span<const glm::dvec2> points, double tangent) {
  double right = -infinity, left = -infinity;
  for (const glm::dvec2& p : points)
    right = std::max(right, p.x / tangent + p.y), left = std::max(left, -p.x / tangent + p.y);
  return {tangent * (right - left) / 2, (right + left) / 2};
}

// Where a camera at a distance has the outermost points as far to the right as to the left: their sum falls as it moves
// to the right.
double centred(std::span<const glm::dvec2> points, double distance) {
  Extent range = extent_of(points, 0);
  for (int i = 0; i < 100; ++i) {
    const double at = range.least + (range.most - range.least) / 2;
    Extent seen;
    for (const glm::dvec2& p : points) {
      const double x = (p.x - at) / (distance - p.y);
      seen.least = std::min(seen.least, x), seen.most = std::max(seen.most, x);
    }
    (seen.least + seen.most > 0 ? range.least : range.most) = at;
  }
  return range.least + (range.most - range.least) / 2;
}

}  // namespace

Fit fit_perspective(ViewHulls& hulls, const glm::dmat3& axes, double tan_x, double tan_y, double margin) {
  const std::vector<glm::dvec2>&x = hulls.x.points(), &y = hulls.y.points();
  CHECK(!x.empty() && !y.empty() && tan_x > 0 && tan_y > 0 && margin >= 0 && margin < 1);
  const Extent depth = extent_of(x, 1);
  const double radius = std::max({extent_of(x, 0).half(), extent_of(y, 0).half(), depth.half()});
  const Apex across = apex_of(x, tan_x * (1 - margin)), up = apex_of(y, tan_y * (1 - margin));
  // What is flat and seen edge-on takes no room: it stays a little before the camera.
  const double d = std::max({across.distance, up.distance, depth.most + 0.002 * radius});
  return {.position = hulls.middle + axes * glm::dvec3(centred(x, d), centred(y, d), d), .nearest_m = d - depth.most};
}

Fit fit_orthographic(ViewHulls& hulls, const glm::dmat3& axes, double aspect, double margin) {
  const Extent x = extent_of(hulls.x.points(), 0), y = extent_of(hulls.y.points(), 0),
               z = extent_of(hulls.x.points(), 1);
  CHECK(aspect > 0 && margin >= 0 && margin < 1 && x.most >= x.least);
  const double size = std::max({x.half(), y.half(), z.half(), 1e-30});
  Fit fit;
  fit.nearest_m = size;
  fit.position = hulls.middle + axes * glm::dvec3(x.least + x.half(), y.least + y.half(), z.most + size);
  fit.half_height = std::max({y.half(), x.half() / aspect, 1e-6 * size}) / (1 - margin);
  return fit;
}

Fit fit_orthographic(std::span<const glm::dvec3> points, const glm::dmat3& axes, double aspect, double margin) {
  CHECK(!points.empty() && aspect > 0 && margin >= 0 && margin < 1);
  const glm::dvec3 middle = mean_of(points);
  glm::dvec3 least(infinity), most(-infinity);
  for (const glm::dvec3& point : points) {
    const glm::dvec3 p = glm::transpose(axes) * (point - middle);
    least = glm::min(least, p), most = glm::max(most, p);
  }
  const glm::dvec3 half = (most - least) / 2.0;
  const double size = std::max({half.x, half.y, half.z, 1e-30});
  Fit fit;
  fit.nearest_m = size;
  fit.position = middle + axes * glm::dvec3(glm::dvec2(least + half), most.z + fit.nearest_m);
  fit.half_height = std::max({half.y, half.x / aspect, 1e-6 * size}) / (1 - margin);
  return fit;
}

std::vector<glm::dvec3> corners_of(const DAabb& box) {
  std::vector<glm::dvec3> corners;
  for (int c = 0; c < 8; ++c)
    corners.emplace_back(c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y, c & 4 ? box.max.z : box.min.z);
  return corners;
}

std::vector<glm::dvec3> turned_once(const DAabb& box, glm::dvec3 right) {
  constexpr int steps = 128;
  const glm::dvec3 centre = box.centre(), half = (box.max - box.min) / 2.0;
  const glm::dvec3 level(right.x, 0, right.z),
      side = glm::length(level) > 0 ? glm::normalize(level) : glm::dvec3(1, 0, 0);
  // Of a polygon about the circle.
  const double radius = std::hypot(half.x, half.z) / std::cos(std::numbers::pi / steps);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < steps; ++i)
    for (const double y : {-half.y, half.y}) {
      const double turn = 2 * std::numbers::pi * i / steps;
      points.push_back(centre + radius * (std::cos(turn) * side + std::sin(turn) * glm::dvec3(-side.z, 0, side.x)) +
                       glm::dvec3(0, y, 0));
    }
  return points;
}

}  // namespace candela
