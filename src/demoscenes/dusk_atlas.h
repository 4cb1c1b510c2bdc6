#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

// Pictures of light in the scene street-dusk: rooms behind windows, shops, and signs of neon tubes, as cells of one
// texture each. Values are linear before they are encoded as sRGB.
namespace candela::dusk {

struct Atlas {
  int columns, rows;
  std::vector<std::byte> png;
};
// The lower left and the upper right corner of a cell as texture coordinates, for MeshKit::quad. Cells are numbered
// from the upper left.
struct Cell {
  glm::dvec2 corner, far;
};
Cell cell_of(int columns, int rows, int index);

constexpr int room_columns = 8, room_rows = 8, dark_rooms = 14;  // the first ones have no light
Atlas make_rooms(uint64_t seed);
constexpr int shop_columns = 4, shop_rows = 2;
Atlas make_shops(uint64_t seed);
Atlas make_near_shops(uint64_t seed);  // of goods that bear a look from a few metres

// Signs that lie, four times as wide as high, and signs that stand, four times as high as wide.
constexpr int lying_signs = 8, standing_signs = 8;
Atlas make_lying_signs();
Atlas make_standing_signs();
glm::dvec3 lying_sign_color(int index);
glm::dvec3 standing_sign_color(int index);

// Flat colours: a texel each, for what glows without a pattern.
enum Glow {
  no_glow,
  lamp_glow,
  head_glow,
  tail_glow,
  red_glow,
  amber_glow,
  green_glow,
  fairy_glow,
  cool_glow,
  glow_count
};
Atlas make_glows();
glm::dvec2 glow_uv(Glow glow);

}  // namespace candela::dusk
