#include "testscenes/mesh_kit.h"
#include "testscenes/table.h"

namespace candela {
namespace {

// A cell of a cuboid's face, moved outwards by `height` with walls around it.
void add_cell(MeshKit& kit, const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, double height) {
  const glm::dvec3 out = glm::normalize(glm::cross(u, v)) * height;
  kit.quad(paint, corner + out, u, v);
  if (height == 0) return;
  kit.quad(paint, corner, u, out);
  kit.quad(paint, corner + u, v, out);
  kit.quad(paint, corner + u + v, -u, out);
  kit.quad(paint, corner + v, -v, out);
}

}  // namespace

// Few large triangles, two a rectangle, aslant: whatever plane cuts space cuts them.
void make_triangles(GlbWriter& out, SceneOptions&) {
  const Paint paint{out.material("grey", pbr({0.7, 0.7, 0.7, 1}, 0, 0.9))};
  MeshKit kit;
  const auto rectangle = [&](glm::dvec3 centre, double turn, double width, double height) {
    const glm::dvec3 u(width * std::cos(turn), 0, -width * std::sin(turn)), v(0, height, 0.1 * height);
    kit.quad(paint, centre - (u + v) * 0.5, u, v);
  };
  rectangle({-1.4, 1.7, 0.2}, -0.35, 3.2, 0.8);
  rectangle({-1.0, 0.4, -1.0}, 0.25, 0.8, 2.4);
  rectangle({0.1, 0.3, -0.2}, 0.1, 0.75, 0.75);
  rectangle({1.2, 1.4, -1.6}, 0.0, 2.0, 0.8);
  rectangle({1.6, 0.2, 0.4}, 0.4, 1.9, 1.8);
  out.node("rectangles", {{"mesh", kit.write(out, "rectangles")}});
  add_sun(out, {1, 2, 3}, {1, 1, 1}, 3);
  out.camera_node({0, 0.8, 6}, {0, 0.8, 0}, 0.7);
}

// A finely cut cuboid some of whose cells stand out by random lengths: many triangles in the planes of the axes.
void make_cuboid(GlbWriter& out, SceneOptions& options) {
  constexpr int cells = 16;
  constexpr double cell = 2.0 / cells;
  const Paint paint{out.material("grey", pbr({0.7, 0.7, 0.7, 1}, 0, 0.9))};
  MeshKit kit;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 u(0), v(0), from(0);
      from[axis] = side, from[(axis + 1) % 3] = from[(axis + 2) % 3] = -1;
      u[(axis + (side > 0 ? 1 : 2)) % 3] = cell, v[(axis + (side > 0 ? 2 : 1)) % 3] = cell;  // u x v points outwards
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          const bool stands_out = options.rng.next() % 5 == 0;
          const double length = options.rng.uniform(0.1, 1.0);
          add_cell(kit, paint, from + u * double(i) + v * double(j), u, v, stands_out ? length : 0);
        }
    }
  out.node("cuboid", {{"mesh", kit.write(out, "cuboid")}});
  add_sun(out, {1, 2, 3}, {1, 1, 1}, 3);
  out.camera_node({3, 2.5, 5}, {0, 0, 0}, 0.6);
}

}  // namespace candela
