#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "demoscenes/dusk.h"

// The road with its markings, kerbs, pavements and covers.
namespace candela::dusk {
namespace {

using std::numbers::pi;
constexpr double far_x_m = 70, paint_m = 0.006;

void flat(MeshKit& kit, const Paint& paint, double x0, double x1, double z_near, double z_far, double y) {
  kit.quad(paint, {x0, y, z_near}, {x1 - x0, 0, 0}, {0, 0, z_far - z_near});
}

// Pavement between a kerb of stone and the houses. Blocks are cut so that no triangle is very long.
void pavement(MeshKit& kit, const Materials& m, double side, double z_near, double z_far) {
  const Paint stone = m.stone.tinted(glm::dvec3(0.42, 0.42, 0.43));
  const double inner = side * (road_half_m + 0.28), kerb = side * road_half_m, wall = side * (facade_m + 0.5);
  const int pieces = int(std::ceil((z_near - z_far) / 12));
  for (int i = 0; i < pieces; ++i) {
    const double z0 = z_near + (z_far - z_near) * i / pieces, z1 = z_near + (z_far - z_near) * (i + 1) / pieces;
    flat(kit, m.pavement, std::min(inner, wall), std::max(inner, wall), z0, z1, kerb_m);
    flat(kit, stone, std::min(kerb, inner), std::max(kerb, inner), z0, z1, kerb_m + 0.004);
    if (side < 0)
      kit.quad(stone, {kerb, 0, z0}, {0, 0, z1 - z0}, {0, kerb_m + 0.004, 0});
    else
      kit.quad(stone, {kerb, 0, z1}, {0, 0, z0 - z1}, {0, kerb_m + 0.004, 0});
  }
  // Towards the junction.
  const double z_end = z_far == far_end_m ? z_near : z_far;
  const double x0 = std::min(kerb, wall), x1 = std::max(kerb, wall);
  if (z_end == z_far)
    kit.quad(stone, {x1, 0, z_end}, {x0 - x1, 0, 0}, {0, kerb_m, 0});
  else
    kit.quad(stone, {x0, 0, z_end}, {x1 - x0, 0, 0}, {0, kerb_m, 0});
}

void cover(MeshKit& kit, const Materials& m, glm::dvec2 at) {
  const auto disc = [&](double radius, double y, double grey) {
    kit.tube(m.metal.tinted(glm::dvec3(grey)), {at.x, -0.05, at.y}, radius, {at.x, y, at.y}, radius, 20, true);
  };
  disc(0.38, 0.006, 0.05);
  disc(0.32, 0.012, 0.14);
}

}  // namespace

void add_ground(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const int pieces = 10;
  for (int i = 0; i < pieces; ++i) {
    const double step = (far_end_m - 8 - near_end_m) / pieces;
    flat(kit, m.asphalt, -road_half_m, road_half_m, near_end_m + step * i, near_end_m + step * (i + 1), 0);
  }
  for (double side : {-1.0, 1.0}) {
    const double x0 = side < 0 ? -far_x_m : road_half_m, x1 = side < 0 ? -road_half_m : far_x_m;
    flat(kit, m.asphalt, x0, x1, cross_near_m, cross_far_m, 0);
    pavement(kit, m, side, near_end_m, cross_near_m);
    pavement(kit, m, side, cross_far_m, far_end_m);
  }

  const Paint white = m.line_paint.tinted(glm::dvec3(0.19, 0.19, 0.18)),
              yellow = m.line_paint.tinted({0.4, 0.26, 0.05});
  const auto dashes = [&](double x, double z_near, double z_far) {
    for (double z = z_near; z - 2.5 > z_far; z -= 6) flat(kit, white, x - 0.07, x + 0.07, z, z - 2.5, paint_m);
  };
  dashes(0, -9, cross_near_m + 6);
  dashes(0, cross_far_m - 6, far_end_m);
  for (auto [near_m, far_m] : {std::pair(-9.0, cross_near_m + 5), std::pair(cross_far_m - 5, far_end_m)})
    for (double side : {-1.0, 1.0}) {
      const double x = side * 3.45;
      for (double z = near_m; z - 5.2 > far_m; z -= 5.6) {  // bays along the kerb
        flat(kit, white, std::min(x, x + side * 0.1), std::max(x, x + side * 0.1), z, z - 5.2, paint_m);
        flat(kit, white, std::min(x, side * road_half_m), std::max(x, side * road_half_m), z, z - 0.1, paint_m);
      }
      flat(kit, yellow, side * 5.28 - 0.05, side * 5.28 + 0.05, near_m + 9, near_m, paint_m);
    }
  // Crossings: one before the camera, two at the junction.
  for (double z : {-2.2, cross_near_m + 4.2, cross_far_m - 1.2})
    for (int i = 0; i < 10; ++i) {
      const double x = -4.95 + 1.1 * i;
      flat(kit, white, x - 0.28, x + 0.28, z, z - 3.2, paint_m);
    }
  flat(kit, white, 0.1, 3.4, 0.2, -0.2, paint_m);
  flat(kit, white, -3.4, -0.1, -7.2, -7.6, paint_m);
  flat(kit, white, 0.1, 3.4, cross_near_m + 6.4, cross_near_m + 6.0, paint_m);
  for (glm::dvec2 at : {glm::dvec2(0.9, -11.5), glm::dvec2(-1.7, -20), glm::dvec2(1.6, -33), glm::dvec2(-0.8, -0.3),
                        glm::dvec2(0.4, -53)})
    cover(kit, m, at);
  for (double z : {4.0, -14.0, -30.0, -44.0})
    for (double side : {-1.0, 1.0})  // gullies
      flat(kit, m.metal.tinted(glm::dvec3(0.04)), side * 5.2 - 0.2, side * 5.2 + 0.2, z, z - 0.6, 0.005);
  out.node("ground", {{"mesh", kit.write(out, "ground")}});
}

}  // namespace candela::dusk
