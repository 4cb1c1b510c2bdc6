#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace candela {

// A mesh from formulas, in double so that files rounded to float come out the same on every machine. Counter-clockwise
// is the front. Arrays are empty or position.size() long.
struct Shape {
  std::vector<glm::dvec3> position, normal;
  std::vector<glm::dvec2> uv;
  std::vector<glm::dvec4> color;
  std::vector<glm::dvec4> tangent;  // w: the bitangent's sign
  std::vector<uint32_t> index;
};

// A point of an outline that turns about +Y: radius and height, and the outward normal in the same plane. The outline
// runs upwards on the outside. Two points at one place make a crease.
struct OutlinePoint {
  double radius, y, normal_radius, normal_y;
};
Shape lathe(std::span<const OutlinePoint> outline, int segments, glm::dvec2 uv_repeat = {1, 1});

Shape sphere(double radius, int segments, int rings, glm::dvec2 uv_repeat = {1, 1});
Shape torus(double ring_radius, double tube_radius, int segments, int sides, glm::dvec2 uv_repeat = {1, 1});
// A column with a flared foot and head, its foot at y = 0.
Shape column(double radius, double height, int segments);
// Faces are cut into cells x cells quads; uv covers each face once.
Shape box(glm::dvec3 size, int cells = 1);
// In the XY plane, facing +Z.
Shape quad(double width, double height, glm::dvec2 uv_repeat = {1, 1});
// In the XZ plane, facing +Y, cut into cells x cells quads.
Shape ground(double size, int cells, double uv_repeat);
// With tangents along the first texture coordinate; the second one runs against the bitangent, for images have their
// first row on top.
Shape with_tangents(Shape shape);

}  // namespace candela
