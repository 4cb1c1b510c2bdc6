#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"

// Street lamps and trees along the roads, strings of lights over them, and traffic lights at the crossing.
namespace candela::city {
namespace {

using std::numbers::pi;
constexpr int lamp_groups = 48, string_groups = 6;
constexpr double string_height_m = 8.6;

class Lamps {
 public:
  explicit Lamps(Town& town) : town_(town), lantern_(dusk::make_street_lamp(town.out, town.m)) {
    for (int g = 0; g < lamp_groups; ++g) {
      Group& group = groups_.emplace_back();
      group.on_s = 4.9 + 4.3 * (g * 29 % lamp_groups + town_.rng.uniform()) / lamp_groups;
      group.mesh =
          town.switches.mesh_with(lantern_.mesh, town.m.glows, town.switches.material(town.m.glows, group.on_s));
    }
    const int tree = dusk::make_tree(town.out, town.m, 13, true);
    trees_ = {dusk::make_tree(town.out, town.m, 11, false), dusk::make_tree(town.out, town.m, 12, false),
              town.switches.mesh_with(tree, town.m.glows, town.switches.material(town.m.glows, 7.6))};
    grate_ = dusk::make_tree_grate(town.out, town.m);
    town.tree = trees_[0], town.tree_grate = grate_;
  }

  void make() {
    for (int c = 0; c < block_columns; ++c)
      for (int r = 0; r < block_rows; ++r)
        for (int side = 0; side < 4; ++side) {
          const glm::dvec2 centre = block_centre(c, r);
          const double turn = side * pi / 2;
          for (double x : {-18.0, 0.0, 18.0}) add_lamp({centre.x, 0, centre.y}, turn, x, pad_half_m - 0.75);
          // Trees along the avenue in the middle, and around the square.
          const bool avenue = (c == 0 && side == 1) || (c == 1 && side == 3);
          if (avenue || is_square(c, r))
            for (double x : {-9.0, 9.0}) add_tree({centre.x, 0, centre.y}, turn, x, pad_half_m - 0.95);
        }
    for (int side = 0; side < 4; ++side) add_lamp({square_centre.x, 0, square_centre.y}, side * pi / 2, 0, -11);
    for (double side : {-1.0, 1.0})
      for (double z = -130; z <= 66; z += 28) add_lamp({0, 0, 0}, -side * pi / 2, side * z, -row_x_m + 5.25);
    for (double x = -60; x <= 60; x += 24) {
      add_lamp({0, 0, 0}, pi, x, -row_near_m + 5.25);
      add_lamp({0, 0, 0}, 0, x, row_far_m + 5.25);
    }
    for (Group& g : groups_) {
      g.lamps.write(town_.out, "street lamps", spot(town_.switches, "street lamp", 22, 0.3, 0.92, g.on_s));
    }
    add_strings();
    add_traffic_lights();
  }

 private:
  struct Group {
    double on_s = 0;
    int mesh = -1;
    LightArrays lamps;
  };

  // At (x, z) of a frame whose road is towards +Z.
  void add_lamp(glm::dvec3 origin, double turn, double x, double z) {
    const glm::dmat4 frame = placed(origin, turn);
    const glm::dvec3 foot(frame * glm::dvec4(x, kerb_m, z, 1));
    const double arm_turn = turn - pi / 2;
    const glm::dvec3 at(placed(foot, arm_turn) * glm::dvec4(lantern_.at, 1));
    Group& g = groups_[next_group_++ % groups_.size()];
    town_.instances.add(g.mesh, foot, arm_turn);
    g.lamps.add(at, {1, 0.62 + 0.06 * town_.rng.uniform(), 0.3}, town_.rng.uniform(1000, 1300), 22, {0, 1, 0});
    g.lamps.aim(glm::dmat3(frame) * glm::dvec3(0, -1, 0.12));
  }

  void add_tree(glm::dvec3 origin, double turn, double x, double z) {
    const glm::dvec3 at(placed(origin, turn) * glm::dvec4(x, kerb_m, z, 1));
    town_.instances.add(trees_[next_tree_++ % trees_.size()], at, town_.rng.uniform(0, 2 * pi),
                        town_.rng.uniform(0.8, 1.05));
    town_.instances.add(grate_, at);
  }

  void add_strings() {
    const double span = 2 * dusk::facade_m;
    const int bare = dusk::make_cable(town_.out, town_.m, span, 1.1, 18);
    for (int g = 0; g < string_groups; ++g) {
      const double on_s = 6.4 + 0.5 * g;
      const int mesh = town_.switches.mesh_with(bare, town_.m.glows, town_.switches.material(town_.m.glows, on_s));
      LightArrays lights;
      const auto add = [&](glm::dvec3 at, double turn) {
        town_.instances.add(mesh, at, turn);
        for (double x : {-7.0, -4.2, -1.4, 1.4, 4.2, 7.0}) {
          const double t = x / span + 0.5, y = -4.4 * t * (1 - t) - 0.2;
          lights.add(glm::dvec3(placed(at, turn) * glm::dvec4(x, y, 0, 1)), {1, 0.6, 0.28}, 7, 10, {0, 1, 0});
          lights.aim({0, -1, 0});
        }
      };
      // Over the avenue beyond the crossing, and over the street beside the square.
      add({0, string_height_m, -14.0 - 7.0 * g}, 0);
      add({0, string_height_m, -78.0 - 7.0 * g}, 0);
      add({0, string_height_m, 34.0 - 5.0 * g}, 0);
      add({14.0 + 7.0 * g, string_height_m, 0}, pi / 2);
      add({-14.0 - 7.0 * g, string_height_m, 0}, pi / 2);
      add({14.0 + 7.0 * g, string_height_m, -pitch_m}, pi / 2);
      lights.write(town_.out, "strings of lights", spot(town_.switches, "string of lights", 10, 0.6, 1.1, on_s));
    }
  }

  void add_traffic_lights() {
    const dusk::TrafficLight red = dusk::make_traffic_light(town_.out, town_.m, true),
                             green = dusk::make_traffic_light(town_.out, town_.m, false);
    LightArrays lights;
    for (int side = 0; side < 4; ++side) {
      // On the left of who comes to the crossing, its arm over the road.
      const glm::dmat4 frame = placed({0, 0, 0}, side * pi / 2);
      const glm::dvec3 foot(frame * glm::dvec4(-dusk::road_half_m - 0.5, kerb_m, dusk::road_half_m + 0.5, 1));
      const dusk::TrafficLight& light = side % 2 ? green : red;
      town_.instances.add(light.mesh, foot, side * pi / 2);
      for (glm::dvec3 lamp : light.lamps)
        lights.add(glm::dvec3(placed(foot, side * pi / 2) * glm::dvec4(lamp, 1)),
                   side % 2 ? glm::dvec3(0.05, 1, 0.4) : glm::dvec3(1, 0.06, 0.03), 4, 8, {0, 1, 0});
      for (size_t i = 0; i < light.lamps.size(); ++i) lights.aim(glm::dmat3(frame) * glm::dvec3(0, -0.4, 1));
    }
    lights.write(town_.out, "traffic lights",
                 town_.out.light({{"name", "traffic light"},
                                  {"type", "spot"},
                                  {"range", 8},
                                  {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 1.1}}}}));
  }

  Town& town_;
  dusk::Lantern lantern_;
  std::vector<Group> groups_;
  std::array<int, 3> trees_{};
  int grate_ = -1;
  size_t next_group_ = 0, next_tree_ = 0;
};

}  // namespace

void add_city_lamps(Town& town) { Lamps(town).make(); }

}  // namespace candela::city
