#pragma once
#include <array>
#include <string>
#include <vector>

#include "demoscenes/dusk.h"

// The parts of the film scene city: a district from the afternoon to the night, of the parts of street-dusk (dusk.h).
// +Y up, metres; avenues run along Z, streets along X, and the sun sets towards -Z.
namespace candela::city {

using dusk::Instances;
using dusk::Materials;

constexpr double end_s = 20, frames_per_s = 24;
constexpr double first_cut_s = 7, second_cut_s = 13;
// The sun falls from 40 to -24 degrees.
constexpr double sun_from_s = 0.6, sun_to_s = 9.8, sun_from_deg = 40, sun_to_deg = -24;
double sun_elevation_deg(double time_s);
// From where the sun shines: a unit vector.
glm::dvec3 sun_direction(double time_s);

// Blocks lie between avenues at x = -64, 0, 64 and streets at z = 64, 0, -64, -128; around them runs a row of houses.
constexpr double pitch_m = 64, block_half_m = 22, pad_half_m = 26.5, kerb_m = dusk::kerb_m;
constexpr double lane_m = 1.8;  // from the middle of a road to the middle of a lane
constexpr int block_columns = 2, block_rows = 3;
constexpr glm::dvec2 square_centre{32, -32};  // x and z
glm::dvec3 camera_at(double time_s);
glm::dvec3 camera_target(double time_s);
// The saucer comes from behind the roofs, and its beam takes the body up.
constexpr double appear_s = second_cut_s - 0.05, arrive_s = 15.0, leave_s = 18.3;
constexpr double lift_from_s = 15.7, lift_to_s = 18.1;
constexpr double beam_from_s = 14.9, beam_full_s = 15.3, beam_to_s = 18.1, beam_off_s = 18.6;
glm::dvec3 saucer_at(double time_s);

glm::dvec2 block_centre(int column, int row);
bool is_square(int column, int row);
constexpr double row_x_m = 74, row_near_m = 74, row_far_m = -138;  // facades of the row of houses around all

// What comes on after dark, each at its moment: copies of lights and of glowing materials that are off before.
class Switches {
 public:
  explicit Switches(GlbWriter& out) : out_(out) {}
  int material(int glowing, double on_s);
  int light(json properties, double on_s);
  // A mesh of the same geometry with another material in the place of one.
  int mesh_with(int mesh, int from_material, int to_material);

 private:
  void animate(const std::string& pointer, int components, double on_s);
  GlbWriter& out_;
};

int spot(Switches& switches, const char* name, double range_m, double inner_rad, double outer_rad, double on_s);
int point(Switches& switches, const char* name, double range_m, double on_s);

// What the parts share.
struct Town {
  GlbWriter& out;
  Rng rng;
  Materials m;
  Switches switches;
  Instances instances;
  int tree = -1, tree_grate = -1;  // of the lamps' part, for the square
};

// Several nodes play what one sampler holds.
int add_sampler(GlbWriter& out, std::span<const double> times_s, std::span<const double> values, int components);
void play(GlbWriter& out, int sampler, int node, std::string_view path);
void animate_places(GlbWriter& out, int node, std::span<const double> times_s, std::span<const glm::dvec3> places);
void animate_turns(GlbWriter& out, int node, std::span<const double> times_s, std::span<const glm::dquat> turns);

void add_city_ground(Town& town);    // city_ground.cpp
void add_city_houses(Town& town);    // city_houses.cpp
void add_city_lamps(Town& town);     // city_lamps.cpp: lamps, trees, strings of lights
void add_city_square(Town& town);    // city_square.cpp
void add_city_visitors(Town& town);  // city_visitors.cpp: the blob and the saucer
void add_city_film(Town& town);      // city_film.cpp: sun and camera
void add_city_people(Town& town);    // city_people.cpp: they walk, and a foot on the ground stands still
void add_city_cars(Town& town);      // city_cars.cpp: they go round in the right lane and keep clear of each other

// --- city_sky.cpp: radiance of an afternoon and of an evening

glm::dvec3 day_sky_radiance(glm::dvec3 direction, uint64_t seed);
glm::dvec3 night_sky_radiance(glm::dvec3 direction, uint64_t seed);

}  // namespace candela::city
