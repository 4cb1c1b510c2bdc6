#include <cmath>
#include <numbers>
#include <vector>

#include "testscenes/mesh_kit.h"
#include "testscenes/table.h"

namespace candela {
namespace {

using std::numbers::pi;

// A tunnel along -Z, from before the camera to a wall at its end.
constexpr double begin_m = 5, end_m = -17, radius_m = 3;

// How far off the axis the rock lies at depth z in direction a: broad folds and rough stone.
double rock_m(double z, double a) {
  double r = radius_m + 0.5 * std::sin(0.9 * z + 2 * a) + 0.32 * std::sin(2.1 * z - 3 * a + 1) +
             0.14 * std::sin(5.3 * z + 7 * a) + 0.05 * std::sin(13 * z - 11 * a);
  // The floor is flatter.
  const double down = std::max(-std::sin(a), 0.0);
  r -= 0.8 * down * down;
  // Closed at the end.
  const double near_end = std::max((end_m + 2.5 - z) / 2.5, 0.0);
  return r * std::sqrt(std::max(1 - near_end * near_end, 0.0));
}

void add_walls(MeshKit& kit, const Paint& rock) {
  constexpr size_t rows = 150, columns = 96;
  std::vector<glm::dvec3> points;
  for (size_t i = 0; i <= rows; ++i)
    for (size_t j = 0; j < columns; ++j) {
      const double z = begin_m + (end_m - begin_m) * double(i) / rows, a = -2 * pi * double(j) / columns;
      const double r = rock_m(z, a);
      points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
  kit.surface(rock, points, columns, true);
}

// A dripstone about the vertical through (x, z), from y to y + long_m, thick at its foot and thin at its tip; a column
// is waisted. Rings of growth all along.
void add_stone(MeshKit& kit, const Paint& rock, glm::dvec3 foot, double long_m, double thick_m, bool column) {
  constexpr size_t rows = 28, columns = 20;
  std::vector<glm::dvec3> points;
  for (size_t i = 0; i <= rows; ++i)
    for (size_t j = 0; j < columns; ++j) {
      const double v = double(i) / rows, a = 2 * pi * double(j) / columns;
      double r = column ? 0.55 + 0.9 * (v - 0.5) * (v - 0.5) * 2 : 1 - v;
      r *= thick_m * (1 + 0.13 * std::sin(17 * v + foot.x) + 0.1 * std::sin(3 * a + 5 * v + foot.z));
      const double bend = 0.12 * std::sin(2.5 * v + foot.x * 3);
      points.emplace_back(foot.x + bend + r * std::cos(a), foot.y + long_m * v, foot.z - r * std::sin(a));
    }
  kit.surface(rock, points, columns, true);
}

}  // namespace

// For light in the air: lamps behind columns and hanging stones, seen against the light.
void make_cave(GlbWriter& out, SceneOptions& options) {
  json stone = pbr({0.42, 0.38, 0.34, 1}, 0, 0.75);
  stone["doubleSided"] = true;
  const Paint rock{out.material("rock", stone)};
  MeshKit kit;
  add_walls(kit, rock);
  // Columns from floor to ceiling: two near, and a fan about the farthest lamp, through whose gaps its light falls.
  for (const glm::dvec3& at : {glm::dvec3(-1.75, 0, -5.0), glm::dvec3(1.9, 0, -4.1)})
    add_stone(kit, rock, {at.x, -4, at.z}, 8, 0.22 + 0.08 * options.rng.uniform(0, 1), true);
  for (int i = 0; i < 7; ++i) {
    const double turn = (i - 3) * 0.42 + 0.1, away_m = 1.15 + 0.3 * options.rng.uniform(0, 1);
    add_stone(kit, rock, {0.1 + away_m * std::sin(turn), -4, -9.6 + away_m * std::cos(turn)}, 8,
              0.16 + 0.1 * options.rng.uniform(0, 1), true);
  }
  // Hanging and standing stones along the walls.
  for (int i = 0; i < 56; ++i) {
    const double z = options.rng.uniform(end_m + 3, begin_m - 4.5), x = options.rng.uniform(-2.5, 2.5);
    const bool hangs = i % 3 != 0;
    const double wall = std::sqrt(std::max(radius_m * radius_m - x * x, 0.5)) + 0.5;
    const double long_m = options.rng.uniform(0.9, hangs ? 2.5 : 1.7) + 0.5;
    // The middle of the passage stays open.
    if (std::abs(x) < 0.7 && z > -4.5) continue;
    add_stone(kit, rock, {x, hangs ? wall : -wall + 0.5, z}, hangs ? -long_m : long_m, options.rng.uniform(0.08, 0.26),
              false);
  }
  out.node("cave", {{"mesh", kit.write(out, "cave")}});
  const struct {
    glm::dvec3 at, color;
    double candela;
  } lamps[] = {{{0.1, 0.35, -9.6}, {1.0, 0.58, 0.22}, 220},
               {{-2.2, 0.7, -5.9}, {0.1, 0.6, 1.0}, 40},
               {{2.25, -0.35, -5.2}, {0.95, 0.15, 0.5}, 30}};
  for (const auto& lamp : lamps) add_point_light(out, lamp.at, lamp.color, lamp.candela);
  out.camera_node({0.5, -0.6, 1.2}, {-0.05, 0.15, -7}, 1.0);
}

}  // namespace candela
