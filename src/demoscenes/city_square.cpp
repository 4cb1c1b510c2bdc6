#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"

// The square: a fountain amid trees and benches, kiosks, tables, and a carousel of strings of lights above it; and what
// stands on pavements elsewhere.
namespace candela::city {
namespace {

using std::numbers::pi;

std::vector<OutlinePoint> faceted(std::span<const glm::dvec2> p) {
  std::vector<OutlinePoint> outline;
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    const glm::dvec2 along = p[i + 1] - p[i], normal = glm::normalize(glm::dvec2(along.y, -along.x));
    outline.push_back({p[i].x, p[i].y, normal.x, normal.y});
    outline.push_back({p[i + 1].x, p[i + 1].y, normal.x, normal.y});
  }
  return outline;
}

void add_fountain(Town& town, glm::dvec3 at) {
  MeshKit kit;
  const Paint stone = town.m.stone.tinted({0.66, 0.62, 0.55}), water = town.m.glass.tinted({0.05, 0.09, 0.1});
  const auto turned = [&](const Paint& paint, std::initializer_list<glm::dvec2> points, int segments) {
    const std::vector<glm::dvec2> p(points);
    kit.turned(paint, {0, 0, 0}, faceted(p), segments);
  };
  turned(stone, {{3.9, 0}, {3.9, 0.18}, {3.5, 0.22}, {3.5, 0.62}, {3.62, 0.68}, {3.62, 0.8}, {3.3, 0.8}, {3.3, 0.5}},
         28);
  turned(water, {{3.3, 0.6}, {0.3, 0.61}}, 28);
  turned(stone, {{0.5, 0.5}, {0.42, 0.9}, {0.28, 1.1}, {0.24, 1.8}, {1.3, 2.15}, {1.38, 2.3}, {1.2, 2.3}, {0.9, 2.2}},
         20);
  turned(water, {{1.2, 2.24}, {0.2, 2.25}}, 20);
  turned(stone, {{0.2, 2.2}, {0.15, 2.9}, {0.5, 3.15}, {0.54, 3.25}, {0.1, 3.25}, {0.08, 3.7}, {0, 3.9}}, 14);
  town.out.node("fountain", {{"mesh", kit.write(town.out, "fountain")}, {"translation", vector_json(at)}});
  LightArrays lights;
  for (int i = 0; i < 8; ++i) {
    const double a = 2 * pi * i / 8;
    lights.add(at + glm::dvec3(2.4 * std::cos(a), 0.75, 2.4 * std::sin(a)), {0.35, 0.75, 1}, 6, 6,
               {0.35, 2.2, i / 8.0});
    lights.aim({-std::cos(a), 1.1, -std::sin(a)});
  }
  lights.write(town.out, "fountain lamps", spot(town.switches, "fountain lamp", 6, 0.6, 1.1, 7.9));
}

}  // namespace

void add_city_square(Town& town) {
  GlbWriter& out = town.out;
  const Materials& m = town.m;
  Instances& instances = town.instances;
  const glm::dvec3 centre(square_centre.x, kerb_m, square_centre.y);
  add_fountain(town, centre);

  const int bollard = dusk::make_bollard(out, m), bench = dusk::make_bench(out, m), bin = dusk::make_bin(out, m),
            planter = dusk::make_planter(out, m, 5), hydrant = dusk::make_hydrant(out, m);
  const int kiosk = town.switches.mesh_with(dusk::make_kiosk(out, m), m.shops, town.switches.material(m.shops, 6.7));
  const int candles = town.switches.material(m.glows, 7.2);
  const std::array tables{town.switches.mesh_with(dusk::make_table(out, m, {0.4, 0.05, 0.04}), m.glows, candles),
                          town.switches.mesh_with(dusk::make_table(out, m, {0.42, 0.38, 0.3}), m.glows, candles)};
  const std::array bicycles{dusk::make_bicycle(out, m, {0.05, 0.16, 0.14}),
                            dusk::make_bicycle(out, m, {0.3, 0.05, 0.03})};
  const int board = dusk::make_board(out, m);

  for (int i = 0; i < 8; ++i) {
    const double a = 2 * pi * (i + 0.5) / 8;
    const glm::dvec3 way(std::cos(a), 0, std::sin(a));
    // Benches look at the fountain: a bench's front is +X.
    instances.add(bench, centre + 7.6 * way, pi - a);
    if (i % 2) instances.add(bin, centre + 7.6 * glm::dvec3(std::cos(a + 0.22), 0, std::sin(a + 0.22)));
    if (i % 4 == 1 || i % 4 == 2) continue;  // open towards the crossing
    const glm::dvec3 at = centre + 13.5 * way;
    instances.add(town.tree, at, a * 3, town.rng.uniform(0.85, 1.05));
    instances.add(town.tree_grate, at);
  }
  for (double side : {-1.0, 1.0}) instances.add(kiosk, centre + glm::dvec3(side * 19, 0, side * 15), 0.3);
  LightArrays lights;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 2; ++k) {
      const glm::dvec3 at = centre + glm::dvec3(12.0 + 3.4 * k, 0, 2.0 + 3.6 * i);
      instances.add(tables[size_t(k)], at, 0.4 * i);
      lights.add(at + glm::dvec3(0, 0.95, 0), {1, 0.62, 0.25}, 1.6, 4, {0.12, 0.7, 0.17 * (2 * i + k)});
      lights.aim({0, -1, 0});
    }
  lights.write(out, "candles", spot(town.switches, "candle", 4, 0.8, 1.1, 7.2));
  for (int i = 0; i < 4; ++i)
    for (double s : {-1.0, 1.0}) {
      const glm::dmat4 frame = placed(centre, i * pi / 2);
      const auto at = [&](double x, double z) { return glm::dvec3(frame * glm::dvec4(x, 0, z, 1)); };
      instances.add(planter, at(s * 5, 24.6), i * pi / 2 + pi / 2);
      for (double x : {20.5, 22.5, 24.5}) instances.add(bollard, at(s * x, pad_half_m - 0.5));
    }
  // Pavements of the blocks beside the avenue.
  for (int r = 0; r < block_rows; ++r)
    for (double side : {-1.0, 1.0}) {
      const glm::dvec2 block = block_centre(side < 0 ? 0 : 1, r);
      if (block == square_centre) continue;
      const double kerb_x = side * (dusk::road_half_m + 0.9), wall_x = side * (dusk::facade_m - 0.75);
      for (double z : {-13.0, 4.5}) {
        instances.add(bench, {kerb_x, kerb_m, block.y + z}, side < 0 ? 0 : pi);
        instances.add(bin, {kerb_x, kerb_m, block.y + z + 1.8});
      }
      instances.add(hydrant, {kerb_x, kerb_m, block.y + 15.5}, 0.4);
      instances.add(bicycles[size_t(r) % 2], {wall_x, kerb_m, block.y + 12}, 0.15);
      instances.add(board, {wall_x, kerb_m, block.y + 2}, 0.3);
      for (double z : {-16.5, -2.0, 17.0}) instances.add(planter, {wall_x, kerb_m, block.y + z}, 0);
    }
}

}  // namespace candela::city
