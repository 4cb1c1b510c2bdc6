#pragma once
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "testscenes/glb_writer.h"
#include "testscenes/procedural_shapes.h"

namespace candela {

// What a part is made of: a material of the file, a linear colour that multiplies it, and the metres that one repeat of
// its textures covers.
struct Paint {
  int material = 0;
  double tile_m = 1;
  glm::dvec3 tint{1};
  Paint tinted(glm::dvec3 by) const { return {material, tile_m, tint * by}; }
};

// A mesh with a primitive for each material, put together from parts in metres. Counter-clockwise is the front.
class MeshKit {
 public:
  // Where the parts that follow stand: a rotation and a shift.
  void place(const glm::dmat4& transform) { transform_ = transform; }

  // corner, corner + u, corner + u + v, corner + v. Texture coordinates follow the place along u and v, so that quads
  // side by side continue each other's texture.
  void quad(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v);
  // The same, with one cell of a texture: uv_low at the corner's lower end as seen in the image.
  void quad(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec2 uv_corner, glm::dvec2 uv_far);
  void triangle(const Paint& paint, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);
  // A convex polygon, counter-clockwise, that shows one place of its texture.
  void polygon(const Paint& paint, std::span<const glm::dvec3> points, glm::dvec2 uv);

  enum Side : unsigned { left = 1, right = 2, bottom = 4, top = 8, back = 16, front = 32, no_bottom = 59, all = 63 };
  void box(const Paint& paint, glm::dvec3 low, glm::dvec3 high, unsigned sides = no_bottom);

  // A tapered cylinder from a to b, smooth around; `caps` closes both ends.
  void tube(const Paint& paint, glm::dvec3 a, double radius_a, glm::dvec3 b, double radius_b, int sides,
            bool caps = false);
  // An outline that turns about +Y, at `foot`.
  void turned(const Paint& paint, glm::dvec3 foot, std::span<const OutlinePoint> outline, int segments);
  // A smooth surface over rows of points, `columns` each. (row, column), its right, upper right and upper neighbours
  // run counter-clockwise. `closed`: the last column meets the first.
  void surface(const Paint& paint, std::span<const glm::dvec3> points, size_t columns, bool closed);

  bool empty() const { return shapes_.empty(); }
  const std::map<int, Shape>& shapes() const { return shapes_; }  // by material
  int write(GlbWriter& out, std::string_view name) const;

 private:
  uint32_t vertex(Shape& shape, glm::dvec3 at, glm::dvec3 normal, glm::dvec2 uv, glm::dvec3 tint);
  void four(const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, std::span<const glm::dvec2, 4> uv);
  Shape& shape_of(const Paint& paint) { return shapes_[paint.material]; }

  std::map<int, Shape> shapes_;
  glm::dmat4 transform_{1};
};

// A turn about +Y in radians, then a shift.
glm::dmat4 placed(glm::dvec3 at, double turn_rad = 0);

}  // namespace candela
