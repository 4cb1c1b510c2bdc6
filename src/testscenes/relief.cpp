#include <array>
#include <cmath>

#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {
namespace {

// Bricks in a running bond, `rows` of them and half as many abreast, rounded and rough, over the unit square: how deep
// the surface lies, 0 on top and 1 in the joints.
double brick_depth(double u, double v, int rows) {
  const double row = std::floor(v * rows), abreast = rows / 2.0;
  const double shifted = u * abreast + (int(row) % 2 == 0 ? 0 : 0.5);
  const double x = shifted - std::floor(shifted), y = v * rows - row;
  // From the brick's edge, in heights of a brick.
  const double edge = std::min(std::min(x, 1 - x) * 2, std::min(y, 1 - y));
  const double chipped = edge - 0.05 * tiling_noise(u, v, 48, 5);
  const double rough = 0.12 * tiling_noise(u, v, 24, 11) + 0.06 * tiling_noise(u, v, 96, 12);
  return 1 - smooth_step(0.02, 0.16, chipped) * (1 - rough);
}
glm::dvec4 brick_color(double u, double v, int rows) {
  const double row = std::floor(v * rows), column = std::floor(u * rows / 2 + (int(row) % 2 == 0 ? 0 : 0.5));
  const double kind = tiling_noise((column + 0.5) / 16, (row + 0.5) / 16, 16, 21);
  const glm::dvec3 brick = glm::mix(glm::dvec3(0.45, 0.2, 0.14), glm::dvec3(0.62, 0.33, 0.22), kind);
  return glm::dvec4(glm::mix(brick, glm::dvec3(0.55, 0.53, 0.5), smooth_step(0.75, 0.95, brick_depth(u, v, rows))), 1);
}

}  // namespace

// A brick wall whose relief deepens and flattens, with a ball half in it, under a sun that grazes it and a lamp.
void make_relief(GlbWriter& out, SceneOptions&) {
  constexpr int rows = 8, side = 256;
  out.use_extension("CANDELA_relief");
  const int heights = out.texture("heights", png_from(side, side, 3, [](double u, double v) {
                                    return glm::dvec4(glm::dvec3(brick_depth(u, v, rows)), 1);
                                  }));
  const int colors =
      out.texture("bricks", png_from(side, side, 3, [](double u, double v) { return brick_color(u, v, rows); }));
  json bricks = pbr_textured(colors, 0, 0.85);
  bricks["extensions"]["CANDELA_relief"] = {{"heightTexture", {{"index", heights}}}, {"depth", 0.08}};
  const int material = out.material("bricks", bricks);
  const int wall = out.mesh("wall", out.primitive(quad(2, 2)), material);
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 1, 0})}});
  // Beside it, round the corner.
  const glm::dquat turned = rotation_about({0, 1, 0}, 1.5707963267948966);
  out.node("side", {{"mesh", wall}, {"translation", vector_json({-1, 1, 1})}, {"rotation", quaternion_json(turned)}});
  const int floor =
      out.mesh("floor", out.primitive(ground(6, 1, 1)), out.material("floor", pbr({0.35, 0.34, 0.33, 1}, 0, 0.8)));
  out.node("floor", {{"mesh", floor}});
  const int ball =
      out.mesh("ball", out.primitive(sphere(0.3, 48, 32)), out.material("ball", pbr({0.2, 0.35, 0.6, 1}, 0, 0.35)));
  out.node("ball", {{"mesh", ball}, {"translation", vector_json({0.25, 0.8, 0})}});
  add_sun(out, {1.1, 1, 0.45}, {1, 0.93, 0.8}, 2.5);
  add_point_light(out, {-0.5, 1.5, 0.35}, {1, 0.7, 0.4}, 1.2);
  out.animate_pointer("/materials/0/extensions/CANDELA_relief/depth", "LINEAR", std::array{0.0, 2.0, 4.0},
                      std::array{0.08, 0.0, 0.08}, 1);
  out.camera_node({1.5, 1.25, 1.9}, {-0.1, 0.95, 0.1}, 0.75);
}

}  // namespace candela
