#include "testscenes/mesh_kit.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"

namespace candela {
namespace {

using std::numbers::pi;

}  // namespace

glm::dmat4 placed(glm::dvec3 at, double turn_rad) {
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  return {{c, 0, -s, 0}, {0, 1, 0, 0}, {s, 0, c, 0}, {at.x, at.y, at.z, 1}};
}

uint32_t MeshKit::vertex(Shape& shape, glm::dvec3 at, glm::dvec3 normal, glm::dvec2 uv, glm::dvec3 tint) {
  shape.position.emplace_back(transform_ * glm::dvec4(at, 1));
  shape.normal.push_back(glm::normalize(glm::dmat3(transform_) * normal));
  shape.uv.push_back(uv);
  shape.color.emplace_back(tint, 1);
  return uint32_t(shape.position.size() - 1);
}

void MeshKit::four(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v,
                   std::span<const glm::dvec2, 4> uv) {
  Shape& shape = shape_of(paint);
  const glm::dvec3 normal = glm::cross(u, v);
  const uint32_t first = vertex(shape, corner, normal, uv[0], paint.tint);
  vertex(shape, corner + u, normal, uv[1], paint.tint);
  vertex(shape, corner + u + v, normal, uv[2], paint.tint);
  vertex(shape, corner + v, normal, uv[3], paint.tint);
  for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) shape.index.push_back(first + k);
}

void MeshKit::quad(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
  const glm::dvec3 along = glm::normalize(u), up = glm::normalize(v);
  const auto uv = [&](glm::dvec3 p) { return glm::dvec2(glm::dot(p, along), -glm::dot(p, up)) / paint.tile_m; };
  const std::array<glm::dvec2, 4> corners{uv(corner), uv(corner + u), uv(corner + u + v), uv(corner + v)};
  four(paint, corner, u, v, corners);
}

void MeshKit::quad(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec2 uv_corner,
                   glm::dvec2 uv_far) {
  const std::array<glm::dvec2, 4> corners{uv_corner, {uv_far.x, uv_corner.y}, uv_far, {uv_corner.x, uv_far.y}};
  four(paint, corner, u, v, corners);
}

void MeshKit::triangle(const Paint& paint, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  Shape& shape = shape_of(paint);
  const glm::dvec3 along = glm::normalize(b - a), normal = glm::cross(b - a, c - a);
  const glm::dvec3 up = glm::normalize(glm::cross(normal, along));
  for (glm::dvec3 p : {a, b, c})
    shape.index.push_back(
        vertex(shape, p, normal, glm::dvec2(glm::dot(p, along), -glm::dot(p, up)) / paint.tile_m, paint.tint));
}

void MeshKit::polygon(const Paint& paint, std::span<const glm::dvec3> points, glm::dvec2 uv) {
  Shape& shape = shape_of(paint);
  const glm::dvec3 normal = glm::cross(points[1] - points[0], points[2] - points[0]);
  const auto first = uint32_t(shape.position.size());
  for (glm::dvec3 p : points) vertex(shape, p, normal, uv, paint.tint);
  for (uint32_t i = 2; i < points.size(); ++i) shape.index.insert(shape.index.end(), {first, first + i - 1, first + i});
}

void MeshKit::box(const Paint& paint, glm::dvec3 low, glm::dvec3 high, unsigned sides) {
  const glm::dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  if (sides & front) quad(paint, {low.x, low.y, high.z}, x, y);
  if (sides & back) quad(paint, {high.x, low.y, low.z}, -x, y);
  if (sides & right) quad(paint, {high.x, low.y, high.z}, -z, y);
  if (sides & left) quad(paint, low, z, y);
  if (sides & top) quad(paint, {low.x, high.y, high.z}, x, -z);
  if (sides & bottom) quad(paint, low, x, z);
}

void MeshKit::tube(const Paint& paint, glm::dvec3 a, double radius_a, glm::dvec3 b, double radius_b, int sides,
                   bool caps) {
  Shape& shape = shape_of(paint);
  const glm::dvec3 axis = glm::normalize(b - a);
  const glm::dvec3 across =
      glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 other = glm::cross(axis, across);
  const double length = glm::length(b - a), slope = (radius_a - radius_b) / length;
  const auto first = uint32_t(shape.position.size());
  for (int i = 0; i <= sides; ++i) {
    const double angle = 2 * pi * (i % sides) / sides;
    const glm::dvec3 out = std::cos(angle) * across + std::sin(angle) * other;
    const double u = double(i) / sides * 2 * pi * std::max(radius_a, radius_b) / paint.tile_m;
    vertex(shape, a + radius_a * out, out + slope * axis, {u, 0}, paint.tint);
    vertex(shape, b + radius_b * out, out + slope * axis, {u, -length / paint.tile_m}, paint.tint);
  }
  for (uint32_t i = 0; i < uint32_t(sides); ++i) {
    const uint32_t k = first + 2 * i;
    shape.index.insert(shape.index.end(), {k, k + 2, k + 3});
    if (radius_b > 0) shape.index.insert(shape.index.end(), {k, k + 3, k + 1});
  }
  if (!caps) return;
  for (int end = 0; end < 2; ++end) {
    const double radius = end ? radius_b : radius_a;
    if (radius <= 0) continue;
    const glm::dvec3 centre = end ? b : a, normal = end ? axis : -axis;
    const uint32_t middle = vertex(shape, centre, normal, {0, 0}, paint.tint);
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * pi * i / sides;
      const glm::dvec3 out = std::cos(angle) * across + std::sin(angle) * other;
      vertex(shape, centre + radius * out, normal, glm::dvec2(std::cos(angle), std::sin(angle)) * radius / paint.tile_m,
             paint.tint);
    }
    for (uint32_t i = 0; i < uint32_t(sides); ++i) {
      const uint32_t k = middle + 1 + i, next = middle + 1 + (i + 1) % uint32_t(sides);
      if (end)
        shape.index.insert(shape.index.end(), {middle, k, next});
      else
        shape.index.insert(shape.index.end(), {middle, next, k});
    }
  }
}

void MeshKit::turned(const Paint& paint, glm::dvec3 foot, std::span<const OutlinePoint> outline, int segments) {
  const Shape part = lathe(outline, segments);
  Shape& shape = shape_of(paint);
  const auto first = uint32_t(shape.position.size());
  for (size_t i = 0; i < part.position.size(); ++i)
    vertex(shape, foot + part.position[i], part.normal[i], part.uv[i] / paint.tile_m, paint.tint);
  for (uint32_t k : part.index) shape.index.push_back(first + k);
}

void MeshKit::surface(const Paint& paint, std::span<const glm::dvec3> points, size_t columns, bool closed) {
  CHECK(columns > 1 && points.size() % columns == 0);
  const size_t rows = points.size() / columns, across = closed ? columns : columns - 1;
  std::vector<glm::dvec3> normal(points.size(), glm::dvec3(0));
  const auto at = [&](size_t r, size_t c) { return r * columns + c % columns; };
  std::vector<std::array<size_t, 3>> faces;
  for (size_t r = 0; r + 1 < rows; ++r)
    for (size_t c = 0; c < across; ++c) {
      const std::array<size_t, 4> k{at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)};
      for (const std::array<size_t, 3>& f : {std::array{k[0], k[1], k[2]}, std::array{k[0], k[2], k[3]}}) {
        const glm::dvec3 area = glm::cross(points[f[1]] - points[f[0]], points[f[2]] - points[f[0]]);
        if (glm::length(area) < 1e-9) continue;  // where a row has drawn together into a point
        for (size_t i : f) normal[i] += area;
        faces.push_back(f);
      }
    }
  // The points of a row that is one point share their normal.
  for (size_t r = 0; r < rows; ++r) {
    if (glm::distance(points[at(r, 0)], points[at(r, columns / 2)]) > 1e-9) continue;
    glm::dvec3 sum(0);
    for (size_t c = 0; c < columns; ++c) sum += normal[at(r, c)];
    for (size_t c = 0; c < columns; ++c) normal[at(r, c)] = sum;
  }
  Shape& shape = shape_of(paint);
  const auto first = uint32_t(shape.position.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 n = glm::length(normal[i]) > 1e-12 ? normal[i] : glm::dvec3(0, 1, 0);
    vertex(shape, points[i], n, glm::dvec2(double(i % columns), double(i / columns)) * 0.2 / paint.tile_m, paint.tint);
  }
  for (const auto& f : faces)
    for (size_t i : f) shape.index.push_back(first + uint32_t(i));
}

int MeshKit::write(GlbWriter& out, std::string_view name) const {
  CHECK(!shapes_.empty());
  json primitives = json::array();
  for (const auto& [material, shape] : shapes_) {
    Shape bare = shape;
    bare.color.clear();
    json primitive = out.primitive(bare);
    primitive["attributes"]["COLOR_0"] = out.unorm8_accessor(shape.color);
    primitive["material"] = material;
    primitives.push_back(std::move(primitive));
  }
  const int mesh = out.mesh(name, primitives[0], -1);
  out.root["meshes"][size_t(mesh)]["primitives"] = std::move(primitives);
  return mesh;
}

}  // namespace candela
