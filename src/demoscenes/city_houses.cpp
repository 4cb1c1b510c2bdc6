#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"

// Houses: a few kinds whose walls are instances, each with windows, shops and signs of its own.
namespace candela::city {
namespace {

using dusk::Building;
using dusk::BuildingKit;
using dusk::Facade;
using std::numbers::pi;

constexpr double depth_m = 12, width_m = 10;
constexpr int middle_kinds = 8, corner_kinds = 4, room_groups = 36, shop_groups = 14, rooms_a_part = 6;

struct Kind {
  Building front, side;  // a corner has a second facade to the right
  bool corner = false;
  uint64_t seed = 0;
  int walls = -1;
};

class Houses {
 public:
  explicit Houses(Town& town) : town_(town), kit_(dusk::make_building_kit(town.out, town.m)) {
    for (int g = 0; g < room_groups; ++g)
      rooms_.push_back(town_.switches.material(town_.m.rooms, 4.6 + 6.2 * (g + town_.rng.uniform()) / room_groups));
    for (int g = 0; g < shop_groups; ++g) {
      const double on_s = 4.2 + 4.5 * (g + town_.rng.uniform()) / shop_groups;
      Group& group = groups_.emplace_back();
      group.m = town_.m;
      group.m.rooms = rooms_[size_t(g)];
      group.m.shops = town_.switches.material(town_.m.shops, on_s);
      group.m.lying_signs = town_.switches.material(town_.m.lying_signs, on_s + 0.5);
      group.m.standing_signs = town_.switches.material(town_.m.standing_signs, on_s + 0.8);
      group.on_s = on_s;
    }
    choose_rooms();
    for (int k = 0; k < middle_kinds + corner_kinds; ++k) make_kind(k);
  }

  void make() {
    for (int c = 0; c < block_columns; ++c)
      for (int r = 0; r < block_rows; ++r)
        if (!is_square(c, r)) add_block(block_centre(c, r));
    // The row around all, which faces inwards.
    const auto row = [&](auto at, int count, double turn) {
      for (int i = 0; i < count; ++i) {
        const glm::dvec3 place = at(i);
        if (std::abs(place.x) > 6 || place.z > 0) add_house(any_middle(), place, turn, false);
        if (i % 5 == 4 || i + 1 == count) end_part();
      }
    };
    for (double side : {-1.0, 1.0})
      row([&](int i) { return glm::dvec3(side * row_x_m, kerb_m, row_near_m - 1 - width_m * i); }, 22, -side * pi / 2);
    row([](int i) { return glm::dvec3(-70 + width_m * i, kerb_m, row_near_m); }, 15, pi);
    row([](int i) { return glm::dvec3(-70 + width_m * i, kerb_m, row_far_m); }, 15, 0);
    add_skyline();
    end_part();
    for (Group& group : groups_) {
      group.lights.write(town_.out, "shops", spot(town_.switches, "shop", 9, 0.5, 1.1, group.on_s));
      group.spills.write(town_.out, "windows", spot(town_.switches, "window", 4.5, 0.5, 1.1, group.on_s + 2.2));
    }
  }

 private:
  struct Group {
    Materials m;
    LightArrays lights, spills;
    double on_s = 0;
  };

  // Panes and signs of the houses since the last part are a mesh: what is small is drawn where it is seen.
  void end_part() {
    town_.out.node("panes and signs", {{"mesh", facade_.lights.write(town_.out, "panes and signs")}});
    facade_.lights = MeshKit();
    ++part_;
    choose_rooms();
  }
  void choose_rooms() {
    facade_.rooms.clear();
    for (int i = 0; i < rooms_a_part; ++i)
      facade_.rooms.push_back(rooms_[(part_ * 11 + size_t(i) * 6) % rooms_.size()]);
  }

  void make_kind(int k) {
    static constexpr std::array<glm::dvec3, 6> bricks{{{0.62, 0.36, 0.28},
                                                       {0.5, 0.26, 0.2},
                                                       {0.72, 0.56, 0.42},
                                                       {0.42, 0.3, 0.27},
                                                       {0.6, 0.44, 0.36},
                                                       {0.66, 0.4, 0.3}}};
    static constexpr std::array<glm::dvec3, 6> plasters{{{0.76, 0.6, 0.38},
                                                         {0.7, 0.43, 0.31},
                                                         {0.66, 0.5, 0.4},
                                                         {0.46, 0.53, 0.42},
                                                         {0.78, 0.7, 0.54},
                                                         {0.68, 0.52, 0.26}}};
    Rng& rng = town_.rng;
    Kind kind;
    kind.corner = k >= middle_kinds;
    kind.seed = rng.next();
    Building& b = kind.front;
    b.width = kind.corner ? depth_m : width_m - 0.02;
    b.depth = depth_m - (kind.corner ? 0 : 0.02);
    b.floors = kind.corner ? 4 : 3 + k % 2;
    b.window_kind = k % dusk::window_kinds;
    b.wall = k % 5 < 3 ? town_.m.brick.tinted(bricks[size_t(k) % bricks.size()] * 1.5)
                       : town_.m.plaster.tinted(plasters[size_t(k) % plasters.size()]);
    b.trim = town_.m.stone.tinted(glm::dvec3(0.78, 0.74, 0.66) * rng.uniform(0.6, 1));
    b.floor_m = 3.1 + 0.1 * (k % 5);
    b.shop_signs = k % 3 == 0 ? 2 : 1;
    kind.side = b;
    kind.side.closed = 0;
    if (kind.corner) b.closed = MeshKit::left | MeshKit::back | MeshKit::top;
    // Walls alone, at the origin.
    Facade facade;
    Instances things;
    LightArrays lights;
    build(kind, {0, 0, 0}, 0, town_.m, facade, things, lights);
    kind.walls = facade.walls.write(town_.out, "house");
    kinds_.push_back(std::move(kind));
  }

  // The same seed gives the same walls wherever a kind stands.
  void build(const Kind& kind, glm::dvec3 at, double turn, const Materials& m, Facade& facade, Instances& things,
             LightArrays& lights) const {
    Rng rng(kind.seed);
    facade.walls = MeshKit();
    add_building(kind.front, at, turn, m, kit_, rng, facade, things, lights);
    if (!kind.corner) return;
    const glm::dvec3 side(placed(at, turn) * glm::dvec4(depth_m / 2, 0, -depth_m / 2, 1));
    add_building(kind.side, side, turn + pi / 2, m, kit_, rng, facade, things, lights);
  }

  size_t any_middle() { return next_middle_++ * 5 % middle_kinds; }
  size_t any_corner() { return middle_kinds + next_corner_++ % corner_kinds; }

  // Windows of houses farther off have no frames.
  void add_house(size_t k, glm::dvec3 at, double turn, bool near) {
    Group& group = groups_[(part_ * 5 + next_house_++ % 2 * 3) % groups_.size()];
    Instances none;
    build(kinds_[k], at, turn, group.m, facade_, near ? town_.instances : none, group.lights);
    town_.instances.add(kinds_[k].walls, at, turn);
    while (group.lights.direction.size() < group.lights.translation.size()) group.lights.aim({0, -1, 0});
    if (!near) return;
    // Light that falls out of a few windows.
    const glm::dmat4 frame = placed(at, turn);
    for (int i = 0; i < 4; ++i) {
      const double x = town_.rng.uniform(-0.4, 0.4) * width_m, y = 4.3 + 3.3 * (i % 3) + 1.6;
      group.spills.add(glm::dvec3(frame * glm::dvec4(x, y, 0.5, 1)), {1, 0.7, 0.4}, town_.rng.uniform(0.6, 1.6), 4.5,
                       {0, 1, 0});
      group.spills.aim(glm::dmat3(frame) * glm::dvec3(0, -0.8, 0.6));
    }
  }

  void add_block(glm::dvec2 centre) {
    for (int side = 0; side < 4; ++side) {
      const double turn = side * pi / 2;
      const glm::dmat4 frame = placed({centre.x, 0, centre.y}, turn);
      const auto at = [&](double x) { return glm::dvec3(frame * glm::dvec4(x, kerb_m, block_half_m, 1)); };
      add_house(any_middle(), at(-5), turn, true);
      add_house(any_middle(), at(5), turn, true);
      add_house(any_corner(), at(block_half_m - depth_m / 2), turn, true);
      end_part();
    }
  }

  // Towers behind the houses, and a church where the avenue ends.
  void add_skyline() {
    MeshKit kit;
    Rng& rng = town_.rng;
    const Paint wall = town_.m.plaster.tinted(glm::dvec3(0.3, 0.29, 0.3));
    for (int i = 0; i < 26; ++i) {
      const double angle = -pi / 2 + (i - 12.5) / 13 * 1.5, distance = rng.uniform(215, 330);
      const double x = distance * std::cos(angle), z = -32 + distance * std::sin(angle);
      const double w = rng.uniform(12, 22), h = rng.uniform(24, 46) + (i % 5 == 2 ? rng.uniform(20, 40) : 0);
      kit.box(wall.tinted(glm::dvec3(rng.uniform(0.7, 1.1))), {x - w / 2, 0, z - w / 2}, {x + w / 2, h, z + w / 2});
      for (int floor = 1; floor * 3.6 < h - 3; ++floor)
        for (int c = 0; c < 5; ++c) {
          if (rng.uniform() < 0.45) continue;
          const dusk::Cell cell =
              dusk::cell_of(dusk::room_columns, dusk::room_rows, dusk::dark_rooms + int(rng.next() % 40));
          const double y = floor * 3.6, step = w / 5, s = -w / 2 + step * c + 0.4;
          const int material = facade_.room_material(town_.m);
          facade_.lights.place(glm::dmat4(1));
          facade_.lights.quad({material}, {x + s, y, z + w / 2 + 0.02}, {step - 0.8, 0, 0}, {0, 1.9, 0}, cell.corner,
                              cell.far);
        }
    }
    const Paint stone = town_.m.stone.tinted({0.5, 0.46, 0.4}), slate = town_.m.matte.tinted({0.05, 0.055, 0.065});
    const double z = row_far_m - 1;
    kit.place(placed({0, 0, z}));
    kit.box(stone, {-4.5, 0, -9}, {4.5, 27, 0});
    for (double x : {-4.5, 3.8})
      for (double back : {0.0, -8.3}) kit.box(stone, {x, 0, back - 0.35}, {x + 0.7, 29.5, back + 0.35});
    for (double y : {9.0, 17.0, 26.0}) kit.box(stone, {-4.8, y, -9.3}, {4.8, y + 0.6, 0.3}, MeshKit::all);
    const std::array<glm::dvec3, 4> corners{{{-4.5, 27, 0}, {4.5, 27, 0}, {4.5, 27, -9}, {-4.5, 27, -9}}};
    for (size_t i = 0; i < 4; ++i) kit.triangle(slate, corners[i], corners[(i + 1) % 4], {0, 46, -4.5});
    kit.box(stone, {-9, 0, -24}, {-4.5, 14, -1}), kit.box(stone, {4.5, 0, -24}, {9, 14, -1});
    std::vector<glm::dvec3> clock;
    for (int k = 0; k < 24; ++k)
      clock.emplace_back(1.7 * std::cos(2 * pi * k / 24), 21.5 + 1.7 * std::sin(2 * pi * k / 24), 0.08);
    kit.polygon({town_.switches.material(town_.m.glows, 6.2)}, clock, dusk::glow_uv(dusk::cool_glow));
    kit.box(slate, {-0.1, 21.4, 0.1}, {0.1, 22.9, 0.14}, MeshKit::all);
    kit.box(slate, {-0.1, 21.4, 0.1}, {1.0, 21.6, 0.14}, MeshKit::all);
    kit.box(town_.m.matte.tinted({0.12, 0.06, 0.04}), {-1.6, 0, 0}, {1.6, 4.2, 0.1});
    town_.out.node("skyline", {{"mesh", kit.write(town_.out, "skyline")}});
  }

  Town& town_;
  BuildingKit kit_;
  std::vector<Kind> kinds_;
  std::vector<Group> groups_;
  std::vector<int> rooms_;
  Facade facade_;
  size_t next_middle_ = 0, next_corner_ = 0, next_house_ = 0, part_ = 0;
};

}  // namespace

void add_city_houses(Town& town) { Houses(town).make(); }

}  // namespace candela::city
