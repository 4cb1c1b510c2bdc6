#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/rng.h"
#include "demoscenes/dusk_atlas.h"
#include "testscenes/light_arrays.h"
#include "testscenes/mesh_kit.h"

// The parts of the scene street-dusk. +Y up, metres; the street runs along Z and is seen towards -Z.
namespace candela::dusk {

struct Materials {
  Paint asphalt, pavement, brick, plaster, stone, metal, car_paint, chrome, glass, matte, leaf, bark, line_paint;
  int rooms, shops, lying_signs, standing_signs, glows;
};
// No puddle is smoother than that.
Materials make_materials(GlbWriter& out, uint64_t seed, double least_puddle_roughness = 0, bool near_shops = false);

// A rectangle that glows in one flat colour.
void glow_quad(MeshKit& kit, const Materials& m, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, Glow glow);

// A ring of rectangles between two circles about +Y, around `centre`: (radius, height) of the lower and the upper one.
void glow_band(MeshKit& kit, const Materials& m, glm::dvec3 centre, glm::dvec2 low, glm::dvec2 high, int sides,
               Glow glow);

// Meshes that stand in many places, gathered by name and written as instances.
class Instances {
 public:
  void add(int mesh, glm::dvec3 at, double turn_rad = 0, double scale = 1);
  void write(GlbWriter& out, std::string_view name, int parent = -1) const;
  bool empty() const { return places_.empty(); }

 private:
  struct Places {
    std::vector<double> translation, rotation, scale;
  };
  std::map<int, Places> places_;
};

// --- dusk_buildings.cpp

constexpr int window_kinds = 4;
struct WindowKind {
  int mesh;  // frame, sill and head around an opening whose lower left corner is the origin, facing +Z
  double width, height;
};
struct BuildingKit {
  std::array<WindowKind, window_kinds> windows;
  std::vector<int> roof_things;
};
BuildingKit make_building_kit(GlbWriter& out, const Materials& m);

struct Building {
  double width, depth;
  int floors;
  int window_kind;
  Paint wall, trim;
  double ground_m = 4.3, floor_m = 3.3;
  int shop_signs = 1;
  // What closes it besides the facade: MeshKit::left, right and back, and top for the roof.
  unsigned closed = MeshKit::left | MeshKit::right | MeshKit::back | MeshKit::top;
};
// What a facade puts into the street besides itself.
struct Facade {
  MeshKit walls;   // one building: brick, plaster, stone
  MeshKit lights;  // panes, shop windows and signs of all buildings
  // Neighbours have other shops and signs.
  int next_shop = 0, next_lying_sign = 0, next_standing_sign = 0;
  // Materials that windows take by turns, each the rooms' atlas; empty: Materials::rooms.
  std::vector<int> rooms{};
  size_t next_room = 0;
  int room_material(const Materials& m) { return rooms.empty() ? m.rooms : rooms[next_room++ * 7 % rooms.size()]; }
};
// Puts a building with its facade's middle at `at`, facing the way +Z turns to. Signs and shops come with lights.
void add_building(const Building& b, glm::dvec3 at, double turn_rad, const Materials& m, const BuildingKit& kit,
                  Rng& rng, Facade& facade, Instances& instances, LightArrays& shop_lights);

// --- dusk_cars.cpp: they drive to -Z; the ground is y = 0

enum CarKind { saloon, hatchback, van, taxi, car_kinds };
struct Car {
  int mesh;
  double head_x, head_y, front_z, tail_x, tail_y, back_z;
  double wheel_x, front_axle, back_axle, wheel_m;  // where wheels stand, and their radius
};
// Without wheels it has the arches over them alone, for wheels that turn.
Car make_car(GlbWriter& out, const Materials& m, CarKind kind, glm::dvec3 color, bool lit, bool with_wheels = true);
// A wheel of a car's right side about its own middle.
int make_wheel(GlbWriter& out, const Materials& m, double radius);

// --- dusk_nature.cpp: trees, and people with umbrellas

int make_tree(GlbWriter& out, const Materials& m, uint64_t seed, bool with_lights);
int make_person(GlbWriter& out, const Materials& m, Rng& rng, glm::dvec3 coat, glm::dvec3 umbrella);

// --- dusk_furniture.cpp

struct Lantern {
  int mesh;
  glm::dvec3 at;  // of its light, a hand below the bowl, which would shade it; the arm reaches to +X
};
Lantern make_street_lamp(GlbWriter& out, const Materials& m);
int make_bollard(GlbWriter& out, const Materials& m);
int make_bench(GlbWriter& out, const Materials& m);
int make_bin(GlbWriter& out, const Materials& m);
int make_tree_grate(GlbWriter& out, const Materials& m);
int make_hydrant(GlbWriter& out, const Materials& m);
int make_kiosk(GlbWriter& out, const Materials& m);
struct TrafficLight {
  int mesh;
  std::array<glm::dvec3, 2> lamps;  // red, green; facing +Z
};
TrafficLight make_traffic_light(GlbWriter& out, const Materials& m, bool red);
int make_cable(GlbWriter& out, const Materials& m, double span_m, double sag_m, int bulbs);

// --- dusk_terrace.cpp

int make_bicycle(GlbWriter& out, const Materials& m, glm::dvec3 color);
int make_table(GlbWriter& out, const Materials& m, glm::dvec3 cloth);
int make_planter(GlbWriter& out, const Materials& m, uint64_t seed);
int make_board(GlbWriter& out, const Materials& m);

// --- dusk_ground.cpp

constexpr double road_half_m = 5.5, facade_m = 10.0, kerb_m = 0.14;
constexpr double near_end_m = 22, far_end_m = -150, cross_near_m = -47, cross_far_m = -59;
void add_ground(GlbWriter& out, const Materials& m);

}  // namespace candela::dusk
