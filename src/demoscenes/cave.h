#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/rng.h"
#include "demoscenes/implicit.h"
#include "testscenes/glb_writer.h"

// The parts of the film scene cave-film: a hall of rock with a pool, a bunny on an island, a dragon on a ledge, a wall
// of stones whose relief moves, and three lamps that go round. +Y up, metres; the tunnel by which the camera comes in
// is towards +Z.
namespace candela::cave {

constexpr double end_s = 15, frames_per_s = 24;
constexpr double first_cut_s = 5, second_cut_s = 9.5;
constexpr double water_m = -0.2;
constexpr glm::dvec2 island{0.4, -2.2}, ledge{-4.2, -6.0};  // x and z
constexpr glm::dvec3 shaft_top{1.3, 9.0, 0.45};             // of the light from above

json trilinear();  // a sampler with mip levels
double floor_height(glm::dvec2 at);
// Below 0 in the air, above in the rock.
double air(glm::dvec3 p);

// A text beside the scene, which the look names.
struct Text {
  std::string suffix, text;
};

void add_rock(GlbWriter& out, uint64_t seed);  // cave_rock.cpp: the hall, the pool and the wall
// Stones and dripstones: a mesh each, and lines of where it stands.
struct Stones {
  std::string node, suffix;
  struct Place {
    glm::dvec3 scale, rotation_deg, translation;
  };
  std::vector<Place> places;
};
std::vector<Stones> place_stones(uint64_t seed);
void add_stones(GlbWriter& out, int rock_material);

// cave_beasts.cpp
void add_bunny(GlbWriter& out);
void add_dragon(GlbWriter& out);

// cave_film.cpp: lamps and camera
void add_film(GlbWriter& out);
struct Lamp {
  const char *name, *suffix;
  glm::dvec3 color;
  double candela;
  std::vector<glm::dvec3> points;            // of a closed B-spline
  std::vector<std::array<double, 2>> times;  // seconds, parameter
};
const std::array<Lamp, 3>& lamps();
glm::dvec3 lamp_at(const Lamp& lamp, double parameter);
constexpr double lamp_radius_m = 0.16;

}  // namespace candela::cave
