#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/demo_scenes.h"
#include "demoscenes/dusk.h"
#include "math/transforms.h"
#include "testscenes/table.h"

// A street after sunset and rain: houses of brick and plaster over lit shops, lamps, cars, trees and people. It is made
// for a picture from its camera, which drives forward slowly while cars go by; the seed changes what stands where.
namespace candela {
namespace {

using namespace dusk;

using std::numbers::pi;
constexpr double end_s = 12;

int spot(GlbWriter& out, const char* name, double range, double inner, double outer) {
  return out.light({{"name", name},
                    {"type", "spot"},
                    {"range", number(range)},
                    {"spot", {{"innerConeAngle", number(inner)}, {"outerConeAngle", number(outer)}}}});
}
int point(GlbWriter& out, const char* name, double range) {
  return out.light({{"name", name}, {"type", "point"}, {"range", number(range)}});
}

class Street {
 public:
  Street(GlbWriter& out, uint64_t seed) : out_(out), rng_(seed), m_(make_materials(out, seed & 0xffff)) {}

  void make() {
    add_ground(out_, m_);
    add_houses();
    add_lamps_and_trees();
    add_cars();
    add_people();
    add_small_things();
    write();
  }

 private:
  void add_houses() {
    const BuildingKit kit = make_building_kit(out_, m_);
    Facade facades;
    for (double side : {-1.0, 1.0})
      for (auto [near_m, far_m] : {std::pair(near_end_m, cross_near_m), std::pair(cross_far_m, far_end_m)}) {
        const int count = int(std::round((near_m - far_m) / 11.5));
        std::vector<double> width;
        double sum = 0;
        for (int i = 0; i < count; ++i) sum += width.emplace_back(rng_.uniform(0.75, 1.25));
        double z = near_m;
        for (int i = 0; i < count; ++i) {
          const double w = width[size_t(i)] * (near_m - far_m) / sum;
          add_house(kit, facades, {side * facade_m, 0, z - w / 2}, side < 0 ? pi / 2 : -pi / 2, w - 0.02);
          z -= w;
        }
      }
    add_end(kit, facades);
    out_.node("panes and signs", {{"mesh", facades.lights.write(out_, "panes and signs")}});
  }

  void add_house(const BuildingKit& kit, Facade& facades, glm::dvec3 at, double turn, double width) {
    static constexpr std::array<glm::dvec3, 5> bricks{
        {{0.62, 0.36, 0.28}, {0.5, 0.26, 0.2}, {0.72, 0.56, 0.42}, {0.42, 0.3, 0.27}, {0.6, 0.44, 0.36}}};
    static constexpr std::array<glm::dvec3, 5> plasters{
        {{0.72, 0.64, 0.5}, {0.55, 0.5, 0.46}, {0.66, 0.5, 0.4}, {0.45, 0.5, 0.5}, {0.7, 0.68, 0.62}}};
    Building b;
    b.width = width;
    b.depth = 12;
    b.floors = 3 + int(rng_.next() % 3);
    b.window_kind = int(rng_.next() % window_kinds);
    const bool brick = rng_.next() % 5 < 3;
    b.wall = brick ? m_.brick.tinted(bricks[size_t(rng_.next() % bricks.size())] * 1.5)
                   : m_.plaster.tinted(plasters[size_t(rng_.next() % plasters.size())]);
    b.trim = m_.stone.tinted(glm::dvec3(0.78, 0.74, 0.66) * rng_.uniform(0.6, 1));
    b.floor_m = rng_.uniform(3.1, 3.6);
    b.shop_signs = rng_.next() % 2 ? 2 : 1;
    facades.walls = MeshKit();
    add_building(b, at, turn, m_, kit, rng_, facades, instances_, shop_lights_);
    out_.node("house", {{"mesh", facades.walls.write(out_, "house")}});
  }

  // The street ends before a church, whose tower stands against the sky; roofs lie behind it.
  void add_end(const BuildingKit& kit, Facade& facades) {
    for (double x : {-18.0, 22.0}) add_house(kit, facades, {x, 0, far_end_m - 10}, 0, 14);
    MeshKit church;
    const Paint stone = m_.stone.tinted({0.42, 0.38, 0.34}), slate = m_.matte.tinted({0.05, 0.055, 0.065});
    const double z = far_end_m - 14;
    church.place(placed({9, 0, z}));
    church.box(stone, {-4, 0, -8}, {4, 27, 0});
    for (double x : {-4.0, 3.3})
      for (double back : {0.0, -7.3}) church.box(stone, {x, 0, back - 0.35}, {x + 0.7, 29.5, back + 0.35});
    for (double y : {9.0, 17.0, 26.0}) church.box(stone, {-4.3, y, -8.3}, {4.3, y + 0.6, 0.3}, MeshKit::all);
    const std::array<glm::dvec3, 4> corners{{{-4, 27, 0}, {4, 27, 0}, {4, 27, -8}, {-4, 27, -8}}};
    for (size_t i = 0; i < 4; ++i) church.triangle(slate, corners[i], corners[(i + 1) % 4], {0, 48, -4});
    church.tube(m_.metal, {0, 47.5, -4}, 0.12, {0, 51, -4}, 0.05, 6);
    church.box(m_.metal, {-0.9, 49.3, -4.1}, {0.9, 49.5, -3.9}, MeshKit::all);
    const auto pane = [&](glm::dvec3 low, double w, double h, int room) {
      const Cell cell = cell_of(room_columns, room_rows, room);
      church.quad({m_.rooms}, low, {w, 0, 0}, {0, h, 0}, glm::mix(cell.corner, cell.far, 0.3),
                  glm::mix(cell.corner, cell.far, 0.7));
    };
    for (double x : {-2.4, 0.9}) pane({x, 19, 0.02}, 1.5, 5, dark_rooms + 3);
    church.box(stone, {4, 0, -26}, {16, 12, -2});
    church.box(slate, {3.8, 12, -26.5}, {16.5, 12.4, -1.6}, MeshKit::all);
    std::vector<glm::dvec3> clock;
    for (int k = 0; k < 24; ++k)
      clock.emplace_back(1.5 * std::cos(2 * pi * k / 24), 14 + 1.5 * std::sin(2 * pi * k / 24), 0.05);
    church.polygon({m_.glows}, clock, glow_uv(cool_glow));
    church.box(slate, {-0.1, 13.9, 0.06}, {0.1, 15.2, 0.1}, MeshKit::all);
    church.box(slate, {-0.1, 13.85, 0.06}, {0.9, 14.05, 0.1}, MeshKit::all);
    out_.node("church", {{"mesh", church.write(out_, "church")}});
    // Roofs behind the houses.
    MeshKit roofs;
    for (int i = 0; i < 26; ++i) {
      const double x = rng_.uniform(-75, 75), zr = rng_.uniform(-250, -190), w = rng_.uniform(7, 15),
                   h = rng_.uniform(9, 30) * (std::abs(x) < 22 ? 0.3 : 1);
      roofs.box(m_.matte.tinted(glm::dvec3(0.06, 0.06, 0.07)), {x - w / 2, 0, zr - w}, {x + w / 2, h, zr},
                MeshKit::front | MeshKit::left | MeshKit::right | MeshKit::top);
    }
    out_.node("roofs", {{"mesh", roofs.write(out_, "roofs")}});
  }

  void add_lamps_and_trees() {
    const Lantern lamp = make_street_lamp(out_, m_);
    const std::array trees{make_tree(out_, m_, 11, false), make_tree(out_, m_, 12, false),
                           make_tree(out_, m_, 13, true)};
    const int grate = make_tree_grate(out_, m_);
    const double x = road_half_m + 0.75;
    for (double side : {-1.0, 1.0})
      for (int i = 0; i < 11; ++i) {
        const double z = (side < 0 ? 6.5 : -1.5) - 15.0 * i;
        if (z < cross_near_m + 1.5 && z > cross_far_m - 1.5) continue;
        const glm::dvec3 foot(side * x, kerb_m, z);
        instances_.add(lamp.mesh, foot, side < 0 ? 0 : pi);
        const glm::dvec3 at = foot + glm::dvec3(-side * lamp.at.x, lamp.at.y, 0);
        lamps_.add(at, {1, 0.62 + 0.06 * rng_.uniform(), 0.3}, rng_.uniform(1100, 1400), 24, {0, 1, 0});
        lamps_.aim({-side * 0.12, -1, 0});
        // The bowl itself, seen from all around: it draws long reflections on the wet road.
        bowls_.add(at, {1, 0.6, 0.27}, 10, 20, {0, 1, 0});
        const double between = z - 7.5 + rng_.uniform(-0.8, 0.8);
        if (between > cross_near_m + 3 || (between < cross_far_m - 3 && between > far_end_m + 4)) {
          const glm::dvec3 tree(side * (x + 0.25), kerb_m, between);
          instances_.add(trees[size_t(rng_.next() % trees.size())], tree, rng_.uniform(0, 2 * pi),
                         rng_.uniform(0.8, 1.1));
          instances_.add(grate, tree);
        }
      }
  }

  // A node that carries cars; its lamps go along.
  void add_car_node(const Car& car, glm::dvec3 at, double turn, bool lit, double speed_m_s) {
    const int node = out_.node("driving car", {{"translation", vector_json(at)},
                                               {"rotation", quaternion_json(rotation_about({0, 1, 0}, turn))}});
    out_.child(node, "car", {{"mesh", car.mesh}});
    if (lit) {
      LightArrays head, tail;
      for (double x : {-1.0, 1.0}) {
        head.add({x * car.head_x, car.head_y, car.front_z - 0.15}, {1, 0.93, 0.8}, 60, 30, {0, 1, 0});
        head.aim({0.02 * x, -0.11, -1});
        tail.add({x * car.tail_x, car.tail_y, car.back_z + 0.3}, {1, 0.04, 0.02}, 5, 8, {0, 1, 0});
      }
      out_.child(node, "head lamps", {{"extensions", head.extension(out_, head_light())}});
      out_.child(node, "tail lamps", {{"extensions", tail.extension(out_, tail_light())}});
    }
    const double way = turn == 0 ? -1 : 1;
    const std::array times{0.0, end_s};
    out_.animate(node, "translation", "LINEAR", times,
                 std::array{at.x, at.y, at.z, at.x, at.y, at.z + way * speed_m_s * end_s}, 3);
  }
  int head_light() { return head_light_ >= 0 ? head_light_ : head_light_ = spot(out_, "head lamp", 32, 0.12, 0.5); }
  int tail_light() { return tail_light_ >= 0 ? tail_light_ : tail_light_ = point(out_, "tail lamp", 8); }

  void add_cars() {
    static constexpr std::array<glm::dvec3, 7> colors{{{0.32, 0.02, 0.018},
                                                       {0.42, 0.42, 0.42},
                                                       {0.015, 0.035, 0.12},
                                                       {0.015, 0.016, 0.018},
                                                       {0.03, 0.09, 0.07},
                                                       {0.5, 0.48, 0.43},
                                                       {0.14, 0.15, 0.17}}};
    std::vector<Car> parked, driving;
    for (size_t i = 0; i < 6; ++i)
      parked.push_back(make_car(out_, m_, i == 4 ? van : i % 2 ? hatchback : saloon, colors[i], false));
    const Car cab = make_car(out_, m_, taxi, {0.55, 0.3, 0.02}, true);
    for (size_t i = 0; i < 3; ++i)
      driving.push_back(make_car(out_, m_, i == 1 ? hatchback : saloon, colors[i + 2], true));
    add_car_node(cab, {1.85, 0, -15}, 0, true, 2.2);
    add_car_node(driving[0], {-1.8, 0, -29}, pi, true, 1.4);
    add_car_node(driving[1], {1.75, 0, -37}, 0, true, 2.5);
    add_car_node(driving[2], {-1.85, 0, -66}, pi, true, 3);
    add_car_node(driving[1], {-1.8, 0, -92}, pi, true, 3);
    add_car_node(driving[2], {1.8, 0, -84}, 0, true, 3);
    add_car_node(driving[0], {1.8, 0, -120}, 0, true, 3);
    for (double side : {-1.0, 1.0})
      for (double z = -11.8; z > far_end_m + 8; z -= 5.6) {
        if (z < cross_near_m + 8 && z > cross_far_m - 8) continue;
        const uint64_t which = rng_.next() % 9;
        if (which >= parked.size()) continue;
        instances_.add(parked[which].mesh, {side * (4.5 + rng_.uniform(-0.1, 0.1)), 0, z + rng_.uniform(-0.2, 0.2)},
                       side < 0 ? pi : 0.0);
      }
  }

  void add_people() {
    static constexpr std::array<glm::dvec3, 5> coats{
        {{0.3, 0.22, 0.12}, {0.03, 0.035, 0.06}, {0.05, 0.05, 0.05}, {0.2, 0.03, 0.03}, {0.1, 0.13, 0.12}}};
    static constexpr std::array<glm::dvec3, 5> umbrellas{
        {{0.5, 0.03, 0.03}, {0.02, 0.02, 0.025}, {0.55, 0.36, 0.05}, {0.03, 0.09, 0.2}, {0.4, 0.4, 0.38}}};
    std::vector<int> people;
    for (size_t i = 0; i < 5; ++i) people.push_back(make_person(out_, m_, rng_, coats[i], umbrellas[i]));
    const struct {
      size_t who;
      glm::dvec3 at;
      double turn;
    } places[] = {{0, {-1.7, 0, -4.4}, -1.45},  {3, {-7.1, kerb_m, -9}, 0.1},    {1, {-8.2, kerb_m, -17}, 3.1},
                  {2, {7.3, kerb_m, -13}, 3.2}, {4, {8.3, kerb_m, -21}, 0},      {0, {7.6, kerb_m, -33}, 3.1},
                  {3, {-7.4, kerb_m, -34}, 0},  {2, {-8.4, kerb_m, -33.6}, 0.1}, {4, {2.6, 0, -44.5}, 1.6},
                  {1, {-3.4, 0, -44}, -1.5},    {4, {-8, kerb_m, -70}, 0},       {2, {7.4, kerb_m, -66}, 3}};
    for (const auto& p : places) instances_.add(people[p.who], p.at, p.turn, 0.95 + 0.1 * rng_.uniform());
  }

  void add_small_things() {
    const int bollard = make_bollard(out_, m_), bench = make_bench(out_, m_), bin = make_bin(out_, m_),
              hydrant = make_hydrant(out_, m_), column = make_kiosk(out_, m_);
    for (double side : {-1.0, 1.0}) {
      const double x = side * (road_half_m + 0.55);
      for (double z : {0.6, -0.8, -6.4, -7.8, -40.5, -42.0, -45.6, -60.5, -62.0})
        instances_.add(bollard, {x, kerb_m, z});
      for (double z : {-12.5, -29.0, -68.0}) {
        instances_.add(bench, {side * (road_half_m + 1.2), kerb_m, z + side * 2}, side < 0 ? 0 : pi);
        instances_.add(bin, {side * (road_half_m + 0.8), kerb_m, z + side * 2 - 1.7});
      }
    }
    instances_.add(hydrant, {road_half_m + 0.6, kerb_m, -9.6}, pi);
    instances_.add(hydrant, {-road_half_m - 0.6, kerb_m, -36}, 0);
    instances_.add(column, {-road_half_m - 1.7, kerb_m, -11.2}, 0.3);
    instances_.add(column, {road_half_m + 1.7, kerb_m, -41}, 0.9);
    const int bicycle = make_bicycle(out_, m_, {0.05, 0.16, 0.14}), other = make_bicycle(out_, m_, {0.3, 0.05, 0.03});
    instances_.add(bicycle, {road_half_m + 1.0, kerb_m, -5.1}, 0.25);
    instances_.add(other, {road_half_m + 1.1, kerb_m, -17.2}, 3.0);
    instances_.add(other, {-road_half_m - 1.1, kerb_m, -8.2}, 0.1);
    instances_.add(bicycle, {-road_half_m - 1.5, kerb_m, -24.2}, 3.2);
    const int board = make_board(out_, m_), planter = make_planter(out_, m_, rng_.next());
    const std::array tables{make_table(out_, m_, {0.4, 0.05, 0.04}), make_table(out_, m_, {0.42, 0.38, 0.3})};
    for (int i = 0; i < 3; ++i) {
      instances_.add(tables[0], {facade_m - 1.35, kerb_m, -5.2 - 2.4 * i}, 0.1 * i);
      instances_.add(tables[1], {-facade_m + 1.35, kerb_m, -25.0 - 2.4 * i}, 0.2 * i);
    }
    for (double z : {-3.6, -12.2}) instances_.add(planter, {facade_m - 1.4, kerb_m, z}, pi / 2);
    for (double z : {-0.5, -5.8, -14.5, -38.0})
      for (double side : {-1.0, 1.0}) instances_.add(planter, {side * (facade_m - 0.55), kerb_m, z + side * 0.7}, 0);
    for (double z : {-2.6, -20.0}) instances_.add(board, {-facade_m + 1.5, kerb_m, z}, 0.3);
    instances_.add(board, {facade_m - 1.9, kerb_m, -14.0}, -0.4);
    const TrafficLight red = make_traffic_light(out_, m_, true), green = make_traffic_light(out_, m_, false);
    const auto traffic_light = [&](const TrafficLight& t, glm::dvec3 at, double turn, glm::dvec3 color) {
      instances_.add(t.mesh, at, turn);
      const glm::dmat4 place = placed(at, turn);
      for (glm::dvec3 lamp : t.lamps) points_.add(glm::dvec3(place * glm::dvec4(lamp, 1)), color, 5, 9, {0, 1, 0});
    };
    // Their arms reach over the road: to +X on the left side; on the right side the lamps face away.
    traffic_light(red, {-road_half_m - 0.5, kerb_m, cross_near_m + 5.5}, 0, {1, 0.06, 0.03});
    traffic_light(green, {road_half_m + 0.5, kerb_m, cross_far_m - 3}, pi, {0.05, 1, 0.4});
    const int cable = make_cable(out_, m_, 2 * facade_m, 1.1, 26);
    for (double z : {-19.0, -27.0, -35.0, -64.0, -74.0}) {
      instances_.add(cable, {0, 8.2, z}, 0);
      for (double x : {-6.0, -2.0, 2.0, 6.0}) points_.add({x, 7.3, z}, {1, 0.6, 0.28}, 5, 10, {0, 1, 0});
    }
  }

  void write() {
    instances_.write(out_, "instances");
    lamps_.write(out_, "street lamps", spot(out_, "street lamp", 24, 0.28, 0.68));
    bowls_.write(out_, "lamp bowls", point(out_, "lamp bowl", 20));
    shop_lights_.write(out_, "shops", point(out_, "shop", 9));
    points_.write(out_, "lights over the road", point(out_, "light", 9));
    add_sun(out_, {-0.045, 0.1, -1}, {1, 0.45, 0.18}, 2.6);  // the last of it, along the street
    const glm::dvec3 eye(1.15, 1.5, 5.7), target(-0.35, 3.2, -20);
    const int camera = out_.camera_node(eye, target, 0.74);
    const std::array times{0.0, end_s};
    const glm::dvec3 end = eye + glm::dvec3(-0.3, 0.05, -5);
    out_.animate(camera, "translation", "LINEAR", times, std::array{eye.x, eye.y, eye.z, end.x, end.y, end.z}, 3);
  }

  GlbWriter& out_;
  Rng rng_;
  Materials m_;
  Instances instances_;
  LightArrays lamps_, bowls_, shop_lights_, points_;
  int head_light_ = -1, tail_light_ = -1;
};

}  // namespace

void make_street_dusk(GlbWriter& out, SceneOptions& options) { Street(out, options.rng.next()).make(); }

}  // namespace candela
