#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk.h"

// What shops and people leave on the pavement: tables, plants in tubs, boards, bicycles.
namespace candela::dusk {
namespace {

using std::numbers::pi;

// A ring of tubes in the plane across `axis`.
void ring(MeshKit& kit, const Paint& paint, glm::dvec3 centre, double radius, double thick, int pieces, int sides) {
  const auto at = [&](int i) {
    const double a = 2 * pi * (i % pieces) / pieces;
    return centre + radius * glm::dvec3(0, std::sin(a), std::cos(a));
  };
  for (int i = 0; i < pieces; ++i) kit.tube(paint, at(i), thick, at(i + 1), thick, sides);
}

}  // namespace

int make_bicycle(GlbWriter& out, const Materials& m, glm::dvec3 color) {
  MeshKit kit;
  const Paint paint = m.car_paint.tinted(color), black = m.matte.tinted(glm::dvec3(0.015)), steel = m.chrome;
  constexpr double wheel = 0.34;
  const glm::dvec3 back(0, wheel, 0.52), front(0, wheel, -0.53), crank(0, 0.3, 0.08), saddle(0, 0.88, 0.24),
      head(0, 0.84, -0.36);
  for (glm::dvec3 hub : {back, front}) {
    ring(kit, black, hub, wheel - 0.02, 0.02, 20, 4);
    ring(kit, steel, hub, wheel - 0.045, 0.008, 20, 3);
    for (int i = 0; i < 8; ++i) {
      const double a = pi * i / 8;
      const glm::dvec3 spoke = (wheel - 0.04) * glm::dvec3(0, std::sin(a), std::cos(a));
      kit.tube(steel, hub - spoke, 0.003, hub + spoke, 0.003, 3);
    }
  }
  const auto bar = [&](glm::dvec3 a, glm::dvec3 b, double r) { kit.tube(paint, a, r, b, r, 6); };
  bar(crank, saddle - glm::dvec3(0, 0.1, 0), 0.018);
  bar(crank, head - glm::dvec3(0, 0.12, 0), 0.02);
  bar(saddle - glm::dvec3(0, 0.16, 0), head, 0.018);
  for (double x : {-0.05, 0.05}) {
    bar(back + glm::dvec3(x, 0, 0), crank, 0.01);
    bar(back + glm::dvec3(x, 0, 0), saddle - glm::dvec3(0, 0.16, 0), 0.01);
    bar(front + glm::dvec3(x, 0, 0), head - glm::dvec3(0, 0.12, 0), 0.012);
  }
  kit.tube(steel, head, 0.014, head + glm::dvec3(0, 0.2, 0.04), 0.014, 6);
  const glm::dvec3 grip = head + glm::dvec3(0, 0.2, 0.02);
  kit.tube(steel, grip - glm::dvec3(0.24, 0, 0), 0.012, grip + glm::dvec3(0.24, 0, 0), 0.012, 6);
  for (double x : {-0.24, 0.24})
    kit.tube(black, grip + glm::dvec3(x, 0, 0), 0.018, grip + glm::dvec3(x, -0.01, 0.14), 0.018, 6, true);
  kit.box(black, saddle + glm::dvec3(-0.07, -0.03, -0.14), saddle + glm::dvec3(0.07, 0.03, 0.12), MeshKit::all);
  kit.tube(steel, saddle - glm::dvec3(0, 0.12, 0), 0.014, saddle, 0.014, 5);
  ring(kit, steel, crank, 0.09, 0.008, 12, 3);
  kit.tube(steel, crank, 0.012, crank + glm::dvec3(0.1, -0.13, -0.06), 0.012, 4);
  kit.tube(steel, crank, 0.012, crank + glm::dvec3(-0.1, 0.13, 0.06), 0.012, 4);
  // A basket and the lamp below it.
  const Paint wicker = m.matte.tinted({0.14, 0.09, 0.045});
  kit.box(wicker, head + glm::dvec3(-0.16, 0.0, -0.34), head + glm::dvec3(0.16, 0.2, -0.06),
          MeshKit::all & ~unsigned(MeshKit::top));
  return kit.write(out, "bicycle");
}

int make_table(GlbWriter& out, const Materials& m, glm::dvec3 cloth) {
  MeshKit kit;
  const Paint iron = m.metal.tinted(glm::dvec3(0.1)), wood = m.line_paint.tinted({0.14, 0.07, 0.035});
  kit.tube(m.stone.tinted(glm::dvec3(0.8)), {0, 0.72, 0}, 0.34, {0, 0.745, 0}, 0.34, 18, true);
  kit.tube(iron, {0, 0.02, 0}, 0.03, {0, 0.72, 0}, 0.03, 8);
  kit.tube(iron, {0, 0, 0}, 0.22, {0, 0.03, 0}, 0.05, 12);
  glow_band(kit, m, {0, 0.75, 0}, {0.03, 0}, {0.035, 0.07}, 6, amber_glow);  // a candle in a glass
  for (double side : {-1.0, 1.0}) {
    const double z = side * 0.62;
    kit.box(wood, {-0.2, 0.44, z - 0.2}, {0.2, 0.47, z + 0.2}, MeshKit::all);
    for (double x : {-0.18, 0.18})
      for (double dz : {-0.18, 0.18}) kit.tube(iron, {x, 0, z + dz}, 0.014, {x, 0.44, z + dz}, 0.014, 5);
    const double back = z + side * 0.19;
    for (double x : {-0.18, 0.18}) kit.tube(iron, {x, 0.44, back}, 0.014, {x, 0.88, back + side * 0.06}, 0.014, 5);
    for (double y : {0.62, 0.78})
      kit.box(wood, {-0.2, y, back + side * 0.03 - 0.015}, {0.2, y + 0.08, back + side * 0.03 + 0.015}, MeshKit::all);
  }
  // A parasol, closed against neither rain nor lamps.
  constexpr int columns = 16;
  kit.tube(iron, {0.0, 0.74, 0}, 0.02, {0.0, 2.5, 0}, 0.02, 6);
  std::vector<glm::dvec3> points;
  for (double t : {1.0, 0.66, 0.33, 0.0})
    for (int i = 0; i < columns; ++i) {
      const double a = -2 * pi * i / columns, r = 1.25 * t * (i % 2 ? 0.94 : 1.0);
      points.emplace_back(r * std::cos(a), 2.55 - 0.42 * t, r * std::sin(a));
    }
  kit.surface(m.leaf.tinted(cloth), points, columns, true);
  return kit.write(out, "table");
}

int make_planter(GlbWriter& out, const Materials& m, uint64_t seed) {
  MeshKit kit;
  Rng rng(seed);
  kit.box(m.metal.tinted(glm::dvec3(0.12)), {-0.22, 0, -0.5}, {0.22, 0.48, 0.5});
  kit.box(m.matte.tinted(glm::dvec3(0.02)), {-0.19, 0.4, -0.47}, {0.19, 0.485, 0.47}, MeshKit::top);
  for (int i = 0; i < 150; ++i) {
    const double angle = rng.uniform(0, 2 * pi), up = rng.uniform(0.2, 1), z = rng.uniform(-0.46, 0.46);
    const glm::dvec3 foot(rng.uniform(-0.15, 0.15), 0.45 + rng.uniform(0, 0.45), z);
    const glm::dvec3 way =
        glm::normalize(glm::dvec3(std::cos(angle), up * 1.5, std::sin(angle))) * rng.uniform(0.1, 0.2);
    const glm::dvec3 across = glm::normalize(glm::cross(way, glm::dvec3(0.3, 1, 0.1))) * 0.05;
    const Paint leaf = m.leaf.tinted(glm::dvec3(0.06, 0.13, 0.04) * rng.uniform(0.6, 1.5));
    kit.triangle(leaf, foot, foot + 0.5 * way + across, foot + way);
    kit.triangle(leaf, foot, foot + way, foot + 0.5 * way - across);
  }
  return kit.write(out, "planter");
}

int make_board(GlbWriter& out, const Materials& m) {
  MeshKit kit;
  const Paint wood = m.line_paint.tinted({0.12, 0.06, 0.03}), slate = m.matte.tinted(glm::dvec3(0.02)),
              chalk = m.matte.tinted(glm::dvec3(0.6));
  for (double side : {-1.0, 1.0}) {
    const glm::dvec3 foot(0, 0, side * 0.28), up(0, 1.0, -side * 0.24);
    const glm::dvec3 across(side * 0.6, 0, 0);
    kit.quad(wood, foot - 0.5 * across, across, up);
    const glm::dvec3 out_m = 0.006 * glm::normalize(glm::cross(across, up));
    kit.quad(slate, foot - 0.42 * across + 0.12 * up + out_m, 0.84 * across, 0.8 * up);
    for (int i = 0; i < 5; ++i)
      kit.quad(chalk, foot - (0.3 - 0.03 * (i % 3)) * across + (0.75 - 0.12 * i) * up + 2.0 * out_m,
               (0.6 - 0.14 * (i % 3)) * across, 0.035 * up);
  }
  return kit.write(out, "board");
}

}  // namespace candela::dusk
