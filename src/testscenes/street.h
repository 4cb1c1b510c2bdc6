#pragma once
#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "base/rng.h"
#include "testscenes/glb_writer.h"

// The parts of the scene `street`. A city is a square grid of cells of one block and two streets each: the one along Z
// on the block's -X side, the one along X on its +Z side. Local coordinates begin at the block's centre; metres.
namespace candela::street {

constexpr double cell_m = 64, block_m = 46, pavement_m = 3, road_m = 12;
constexpr double street_centre_m = cell_m / 2;  // from the block's centre
constexpr double lamp_height_m = 7, head_lamp_height_m = 0.65;
constexpr int lamps_a_cell = 16, cars_a_lane = 2, lanes_a_cell = 4, head_lamps_a_cell = lanes_a_cell * cars_a_lane * 2;
constexpr int windows_a_cell = 20, signs_a_cell = 12;
constexpr int lights_a_cell = lamps_a_cell + head_lamps_a_cell + windows_a_cell + signs_a_cell;
static_assert(lights_a_cell == 64);

// Quarter turns about +Y, exactly.
glm::dvec3 turned(int quarters, glm::dvec3 v);

// A point light in front of a facade. Its mesh is there whether or not the light is.
struct Fixture {
  glm::dvec3 at;
  glm::dvec3 color;
};
struct Block {
  int mesh;
  std::array<Fixture, windows_a_cell> windows;
  std::array<Fixture, signs_a_cell> signs;
};

struct Lamp {
  glm::dvec3 at, direction;
};

struct CarPair {  // the cars of one lane of one cell; they drive to -Z
  int mesh;
  std::array<double, cars_a_lane> z;  // of each car's centre
};

struct Parts {
  std::vector<Block> blocks;
  std::vector<CarPair> cars;
  int street_mesh;
  std::array<Lamp, lamps_a_cell> lamps;
};
Parts make_parts(GlbWriter& out, Rng& rng);

}  // namespace candela::street
