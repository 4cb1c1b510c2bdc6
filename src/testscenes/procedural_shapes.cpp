#include "testscenes/procedural_shapes.h"

#include <array>
#include <cmath>
#include <numbers>

namespace candela {

namespace {

using std::numbers::pi;

void add_quad_indices(std::vector<uint32_t>& index, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  index.insert(index.end(), {a, b, c, a, c, d});
}

// Appends a grid over origin + s*edge_u + t*edge_v, s and t in [0,1]; the front faces cross(edge_u, edge_v).
void add_grid(Shape& shape, glm::dvec3 origin, glm::dvec3 edge_u, glm::dvec3 edge_v, int cells, glm::dvec2 uv_repeat) {
  const auto first = uint32_t(shape.position.size());
  const glm::dvec3 normal = glm::normalize(glm::cross(edge_u, edge_v));
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double s = double(i) / cells, t = double(j) / cells;
      shape.position.push_back(origin + s * edge_u + t * edge_v);
      shape.normal.push_back(normal);
      shape.uv.push_back(glm::dvec2(s, 1 - t) * uv_repeat);
    }
  const auto row = uint32_t(cells + 1);
  for (uint32_t j = 0; j < uint32_t(cells); ++j)
    for (uint32_t i = 0; i < uint32_t(cells); ++i) {
      const uint32_t a = first + j * row + i;
      add_quad_indices(shape.index, a, a + 1, a + 1 + row, a + row);
    }
}

}  // namespace

Shape lathe(std::span<const OutlinePoint> outline, int segments, glm::dvec2 uv_repeat) {
  Shape shape;
  const auto rows = uint32_t(outline.size()), columns = uint32_t(segments + 1);
  for (uint32_t j = 0; j < rows; ++j)
    for (uint32_t i = 0; i < columns; ++i) {
      const double angle = 2 * pi * double(i % uint32_t(segments)) / segments;
      const double c = std::cos(angle), s = -std::sin(angle);
      const OutlinePoint& p = outline[j];
      shape.position.emplace_back(p.radius * c, p.y, p.radius * s);
      shape.normal.push_back(glm::normalize(glm::dvec3(p.normal_radius * c, p.normal_y, p.normal_radius * s)));
      shape.uv.push_back(glm::dvec2(double(i) / segments, 1 - double(j) / (rows - 1)) * uv_repeat);
    }
  for (uint32_t j = 0; j + 1 < rows; ++j) {
    const bool crease = outline[j].radius == outline[j + 1].radius && outline[j].y == outline[j + 1].y;
    for (uint32_t i = 0; i + 1 < columns && !crease; ++i) {
      const uint32_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
      if (outline[j].radius > 0) shape.index.insert(shape.index.end(), {a, b, c});
      if (outline[j + 1].radius > 0) shape.index.insert(shape.index.end(), {a, c, d});
      // At a pole one of the two triangles has no area; the other one keeps the surface closed.
    }
  }
  return shape;
}

Shape sphere(double radius, int segments, int rings, glm::dvec2 uv_repeat) {
  std::vector<OutlinePoint> outline;
  for (int j = 0; j <= rings; ++j) {
    const double angle = pi * (double(j) / rings - 0.5);
    const bool pole = j == 0 || j == rings;
    const double c = pole ? 0 : std::cos(angle), s = std::sin(angle);
    outline.push_back({radius * c, radius * s, c, s});
  }
  return lathe(outline, segments, uv_repeat);
}

Shape torus(double ring_radius, double tube_radius, int segments, int sides, glm::dvec2 uv_repeat) {
  std::vector<OutlinePoint> outline;
  for (int j = 0; j <= sides; ++j) {
    const double angle = 2 * pi * double(j % sides) / sides;
    const double c = std::cos(angle), s = std::sin(angle);
    outline.push_back({ring_radius + tube_radius * c, tube_radius * s, c, s});
  }
  return lathe(outline, segments, uv_repeat);
}

Shape column(double radius, double height, int segments) {
  const double wide = 1.5 * radius, plate = 0.05 * height;
  const std::array<OutlinePoint, 12> outline{{{wide, 0, 1, 0},
                                              {wide, plate, 1, 0},
                                              {wide, plate, 0, 1},
                                              {1.2 * radius, plate, 0, 1},
                                              {1.2 * radius, plate, 1, 0.3},
                                              {radius, 3 * plate, 1, 0.05},
                                              {0.85 * radius, height - 3 * plate, 1, 0},
                                              {1.1 * radius, height - plate, 1, -0.4},
                                              {wide, height - plate, 0, -1},
                                              {wide, height - plate, 1, 0},
                                              {wide, height, 1, 0},
                                              {wide, height, 0, 1}}};
  std::vector<OutlinePoint> closed(outline.begin(), outline.end());
  closed.push_back({0, height, 0, 1});
  return lathe(closed, segments, {2, 4});
}

Shape box(glm::dvec3 size, int cells) {
  Shape shape;
  const glm::dvec3 h = size * 0.5, x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  add_grid(shape, {-h.x, -h.y, h.z}, x, y, cells, {1, 1});
  add_grid(shape, {h.x, -h.y, -h.z}, -x, y, cells, {1, 1});
  add_grid(shape, {h.x, -h.y, h.z}, -z, y, cells, {1, 1});
  add_grid(shape, {-h.x, -h.y, -h.z}, z, y, cells, {1, 1});
  add_grid(shape, {-h.x, h.y, h.z}, x, -z, cells, {1, 1});
  add_grid(shape, {-h.x, -h.y, -h.z}, x, z, cells, {1, 1});
  return shape;
}

Shape quad(double width, double height, glm::dvec2 uv_repeat) {
  Shape shape;
  add_grid(shape, {-width / 2, -height / 2, 0}, {width, 0, 0}, {0, height, 0}, 1, uv_repeat);
  return shape;
}

Shape ground(double size, int cells, double uv_repeat) {
  Shape shape;
  add_grid(shape, {-size / 2, 0, size / 2}, {size, 0, 0}, {0, 0, -size}, cells, glm::dvec2(uv_repeat));
  return shape;
}

Shape with_tangents(Shape shape) {
  std::vector<glm::dvec3> sum(shape.position.size(), glm::dvec3(0));
  for (size_t i = 0; i + 2 < shape.index.size(); i += 3) {
    const uint32_t* const corner = &shape.index[i];
    const glm::dvec3 e1 = shape.position[corner[1]] - shape.position[corner[0]],
                     e2 = shape.position[corner[2]] - shape.position[corner[0]];
    const glm::dvec2 d1 = shape.uv[corner[1]] - shape.uv[corner[0]], d2 = shape.uv[corner[2]] - shape.uv[corner[0]];
    const double area = d1.x * d2.y - d2.x * d1.y;
    if (area == 0) continue;
    for (int k = 0; k < 3; ++k) sum[corner[k]] += (e1 * d2.y - e2 * d1.y) / area;
  }
  for (size_t v = 0; v < sum.size(); ++v) {
    const glm::dvec3 n = shape.normal[v], along = sum[v] - n * glm::dot(n, sum[v]);
    const double length = glm::length(along);
    // Poles of spheres have none.
    const glm::dvec3 other = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    shape.tangent.push_back({length > 1e-9 ? along / length : glm::normalize(glm::cross(n, other)), 1});
  }
  return shape;
}

}  // namespace candela
