#include <cmath>

#include "demoscenes/city.h"

// Roads with their markings, and the raised pads that blocks stand on.
namespace candela::city {
namespace {

constexpr double paint_m = 0.006, cell_m = 17;

void flat(MeshKit& kit, const Paint& paint, glm::dvec2 low, glm::dvec2 high, double y) {
  kit.quad(paint, {low.x, y, high.y}, {high.x - low.x, 0, 0}, {0, 0, low.y - high.y});
}

// Cut into cells, so that no triangle is very long.
void cells(MeshKit& kit, const Paint& paint, glm::dvec2 low, glm::dvec2 high, double y) {
  const glm::ivec2 count(glm::ceil((high - low) / cell_m));
  const glm::dvec2 step = (high - low) / glm::dvec2(count);
  for (int i = 0; i < count.x; ++i)
    for (int k = 0; k < count.y; ++k) {
      const glm::dvec2 corner = low + step * glm::dvec2(i, k);
      flat(kit, paint, corner, corner + step, y);
    }
}

// A pad of slabs with a kerb of stone around it.
void pad(MeshKit& kit, const Materials& m, glm::dvec2 low, glm::dvec2 high) {
  constexpr double edge = 0.28;
  const Paint stone = m.stone.tinted(glm::dvec3(0.42, 0.42, 0.43));
  cells(kit, m.pavement, low + edge, high - edge, kerb_m);
  const glm::dvec2 size = high - low;
  for (int side = 0; side < 4; ++side) {
    const double along = side % 2 ? size.y : size.x, across = side % 2 ? size.x : size.y;
    kit.place(placed({(low.x + high.x) / 2, 0, (low.y + high.y) / 2}, side * 1.5707963267948966));
    const int pieces = int(std::ceil(along / cell_m));
    for (int i = 0; i < pieces; ++i) {
      const double x0 = along * (double(i) / pieces - 0.5), x1 = along * ((i + 1.0) / pieces - 0.5), z = across / 2;
      flat(kit, stone, {x0, z - edge}, {x1, z}, kerb_m + 0.004);
      kit.quad(stone, {x0, 0, z}, {x1 - x0, 0, 0}, {0, kerb_m + 0.004, 0});
    }
  }
  kit.place(glm::dmat4(1));
}

// The markings of one arm of a crossing, which leads along +Z from its middle, `length` to the next crossing's middle.
void arm(MeshKit& kit, const Materials& m, double length) {
  constexpr double road = dusk::road_half_m;
  const Paint white = m.line_paint.tinted(glm::dvec3(0.24, 0.24, 0.23)),
              yellow = m.line_paint.tinted({0.4, 0.26, 0.05});
  const double first = road + 1.2;
  for (int i = 0; i < 10; ++i)
    flat(kit, white, {-4.95 + 1.1 * i - 0.28, first}, {-4.95 + 1.1 * i + 0.28, first + 3}, paint_m);
  // Who comes towards the crossing stops before it: cars that go to -Z are at +X.
  flat(kit, white, {0.1, first + 3.8}, {road - 0.3, first + 4.2}, paint_m);
  if (length <= 0) return;
  for (double z = first + 6; z + 2.5 < length / 2; z += 6) flat(kit, white, {-0.07, z}, {0.07, z + 2.5}, paint_m);
  for (double side : {-1.0, 1.0}) {
    const double x = side * 5.25;
    flat(kit, yellow, {x - 0.05, first + 3.5}, {x + 0.05, first + 9}, paint_m);
    flat(kit, m.metal.tinted(glm::dvec3(0.04)), {side * 5.2 - 0.2, first + 11}, {side * 5.2 + 0.2, first + 11.6},
         0.005);
  }
  kit.tube(m.metal.tinted(glm::dvec3(0.05)), {1.2, -0.05, first + 8}, 0.38, {1.2, 0.006, first + 8}, 0.38, 16, true);
}

}  // namespace

void add_city_ground(Town& town) {
  const Materials& m = town.m;
  // A mesh each, so that little of it is drawn where little is seen.
  const auto part = [&](const char* name, const auto& add) {
    MeshKit kit;
    add(kit);
    town.out.node(name, {{"mesh", kit.write(town.out, name)}});
  };
  const double edge_x = row_x_m - 4.5, near_z = row_near_m - 4.5, far_z = row_far_m + 4.5, half = pitch_m / 2;
  // Around each crossing, to the middle of the next, or to the edge.
  for (int x = -1; x <= 1; ++x)
    for (int z = -2; z <= 1; ++z) {
      const glm::dvec2 middle(x * pitch_m, z * pitch_m);
      part("road", [&](MeshKit& kit) {
        cells(kit, m.asphalt, {x == -1 ? -edge_x : middle.x - half, z == -2 ? far_z : middle.y - half},
              {x == 1 ? edge_x : middle.x + half, z == 1 ? near_z : middle.y + half}, 0);
      });
      part("road markings", [&](MeshKit& kit) {
        for (int side = 0; side < 4; ++side) {
          // +Z, +X, -Z, -X: where no road goes on there is no arm.
          if ((side == 0 && z == 1) || (side == 1 && x == 1) || (side == 2 && z == -2) || (side == 3 && x == -1))
            continue;
          kit.place(placed({middle.x, 0, middle.y}, side * 1.5707963267948966));
          arm(kit, m, pitch_m);
        }
      });
    }
  const auto add_pad = [&](glm::dvec2 low, glm::dvec2 high) {
    part("pavement", [&](MeshKit& kit) { pad(kit, m, low, high); });
  };
  for (int c = 0; c < block_columns; ++c)
    for (int r = 0; r < block_rows; ++r) add_pad(block_centre(c, r) - pad_half_m, block_centre(c, r) + pad_half_m);
  const double out = 5;
  add_pad({-edge_x - out, far_z - out}, {-edge_x, near_z + out});
  add_pad({edge_x, far_z - out}, {edge_x + out, near_z + out});
  add_pad({-edge_x, near_z}, {edge_x, near_z + out});
  add_pad({-edge_x, far_z - out}, {edge_x, far_z});
}

}  // namespace candela::city
