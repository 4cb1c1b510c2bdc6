#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "demoscenes/city.h"
#include "testscenes/table.h"

// Cars on closed ways around blocks, all at one speed and always in the right lane. A car is put on its way where it
// comes near no other one in all the film.
namespace candela::city {
namespace {

using std::numbers::pi;
constexpr double speed_m_s = 6.8, corner_m = 8, room_m = 9;
constexpr int most_cars = 58, head_groups = 14;

// A rectangle with round corners, gone round so that its middle is on the right.
struct Way {
  glm::dvec2 low, high;  // x and z

  glm::dvec2 straight() const { return high - low - 2 * corner_m; }
  double arc() const { return corner_m * pi / 2; }
  double length() const { return 2 * (straight().x + straight().y) + 4 * arc(); }

  struct Place {
    glm::dvec2 at;
    double heading;  // the turn about +Y of a car that goes to -Z at 0
  };
  // From the lower left: up the left side (to -Z), along the far one to +X, back down, and to -X.
  Place at(double s) const {
    s = std::fmod(s, length());
    if (s < 0) s += length();
    for (int side = 0;; side = (side + 1) % 4) {
      const double line = side % 2 ? straight().x : straight().y;
      const double turn = -side * pi / 2;
      const glm::dvec2 ahead(-std::sin(turn), -std::cos(turn)), right(std::cos(turn), -std::sin(turn));
      const glm::dvec2 corners[] = {{low.x, high.y - corner_m},
                                    {low.x + corner_m, low.y},
                                    {high.x, low.y + corner_m},
                                    {high.x - corner_m, high.y}};
      if (s < line) return {corners[side] + s * ahead, turn};
      s -= line;
      if (s < arc()) {
        const double a = s / corner_m;
        return {corners[side] + line * ahead + corner_m * (std::sin(a) * ahead + (1 - std::cos(a)) * right), turn - a};
      }
      s -= arc();
    }
  }
  // Ways along it at which straight parts and corners meet, and between them in corners.
  std::vector<double> marks() const {
    std::vector<double> marks;
    double s = 0;
    for (int side = 0; side < 4; ++side) {
      marks.push_back(s);
      s += side % 2 ? straight().x : straight().y;
      for (int i = 0; i < 8; ++i) marks.push_back(s + arc() * i / 8);
      s += arc();
    }
    return marks;
  }
};

// Around the blocks from one to another, both among them.
Way around(glm::ivec2 first, glm::ivec2 last) {
  const double out = pitch_m / 2 - lane_m;
  const glm::dvec2 a = block_centre(first.x, first.y), b = block_centre(last.x, last.y);
  return {glm::min(a, b) - out, glm::max(a, b) + out};
}

std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (int r = 0; r < block_rows; ++r)
    for (int c = 0; c < block_columns; ++c) ways.push_back(around({c, r}, {c, r}));
  for (int c = 0; c < block_columns; ++c) {
    ways.push_back(around({c, 0}, {c, block_rows - 1}));
    ways.push_back(around({c, 0}, {c, 1}));
    ways.push_back(around({c, 1}, {c, 2}));
  }
  for (int r = 0; r < block_rows; ++r) ways.push_back(around({0, r}, {block_columns - 1, r}));
  ways.push_back(around({0, 0}, {block_columns - 1, block_rows - 1}));
  return ways;
}

struct Drive {
  size_t way;
  double start_m;
};

class Cars {
 public:
  explicit Cars(Town& town) : town_(town), ways_(all_ways()) {}

  void make() {
    place_all();
    make_kinds();
    for (size_t i = 0; i < drives_.size(); ++i) add_car(drives_[i], i);
    add_parked();
  }

 private:
  bool is_clear(const Drive& drive) const {
    for (double t = -1; t <= end_s + 1; t += 0.2) {
      const Way::Place me = ways_[drive.way].at(drive.start_m + speed_m_s * t);
      const glm::dvec2 ahead(-std::sin(me.heading), -std::cos(me.heading)), right(-ahead.y, ahead.x);
      for (const Drive& other : drives_) {
        const glm::dvec2 d = ways_[other.way].at(other.start_m + speed_m_s * t).at - me.at;
        const bool oncoming_lane = std::abs(glm::dot(d, right)) > 2.6;
        if (glm::length(d) < (oncoming_lane ? 0.5 * room_m - 1 : room_m)) {
          // In the oncoming lane they pass.
          const double turn = ways_[other.way].at(other.start_m + speed_m_s * t).heading - me.heading;
          if (oncoming_lane && std::cos(turn) < -0.9) continue;
          return false;
        }
      }
    }
    return true;
  }

  void place_all() {
    // These pass before the camera; the others as it comes.
    for (int tries = 0; tries < 4000 && drives_.size() < most_cars; ++tries) {
      const size_t way = size_t(town_.rng.next() % ways_.size());
      const Drive drive{way, town_.rng.uniform() * ways_[way].length()};
      if (is_clear(drive)) drives_.push_back(drive);
    }
  }

  struct Kind {
    dusk::Car car;
    int right_wheel, right_turn, left_turn;
  };

  void make_kinds() {
    static constexpr std::array<glm::dvec3, 6> colors{{{0.32, 0.02, 0.018},
                                                       {0.42, 0.42, 0.42},
                                                       {0.015, 0.035, 0.12},
                                                       {0.55, 0.3, 0.02},
                                                       {0.03, 0.09, 0.07},
                                                       {0.5, 0.48, 0.43}}};
    for (size_t i = 0; i < colors.size(); ++i) {
      const dusk::CarKind shape = i == 3 ? dusk::taxi : i == 5 ? dusk::van : i % 2 ? dusk::hatchback : dusk::saloon;
      Kind kind{make_car(town_.out, town_.m, shape, colors[i], true, false), 0, 0, 0};
      kind.right_wheel = dusk::make_wheel(town_.out, town_.m, kind.car.wheel_m);
      std::vector<double> times, right, left;
      for (int k = 0; k <= int(end_s * frames_per_s / 2); ++k) {
        times.push_back(2 * k / frames_per_s);
        const glm::dquat spin = rotation_about({1, 0, 0}, -speed_m_s * times.back() / kind.car.wheel_m);
        push(right, spin);
        push(left, spin * rotation_about({0, 1, 0}, pi));
      }
      kind.right_turn = add_sampler(town_.out, times, right, 4);
      kind.left_turn = add_sampler(town_.out, times, left, 4);
      kinds_.push_back(kind);
    }
    for (int g = 0; g < head_groups; ++g) {
      const double on_s = 4.4 + 3.6 * (g + town_.rng.uniform()) / head_groups;
      glows_.push_back(town_.switches.material(town_.m.glows, on_s));
      heads_.push_back(spot(town_.switches, "head lamp", 34, 0.12, 0.5, on_s));
      tails_.push_back(spot(town_.switches, "tail lamp", 8, 0.5, 1.1, on_s));
    }
  }

  void add_car(const Drive& drive, size_t number) {
    GlbWriter& out = town_.out;
    const Way& way = ways_[drive.way];
    const Kind& kind = kinds_[number * 5 % kinds_.size()];
    const size_t group = number * 3 % head_groups;
    std::vector<double> ways{0, speed_m_s * end_s};
    for (double mark : way.marks())
      for (int round = 0; round < 3; ++round) {
        const double s = mark - drive.start_m + round * way.length();
        if (s > 0.01 && s < ways[1] - 0.01) ways.push_back(s);
      }
    std::ranges::sort(ways);
    std::vector<double> times;
    std::vector<glm::dvec3> places;
    std::vector<glm::dquat> turns;
    for (double s : ways) {
      const Way::Place place = way.at(drive.start_m + s);
      times.push_back(s / speed_m_s);
      places.emplace_back(place.at.x, 0, place.at.y);
      turns.push_back(rotation_about({0, 1, 0}, place.heading));
    }
    const int node = out.node("car", {{"translation", vector_json(places[0])}});
    animate_places(out, node, times, places);
    animate_turns(out, node, times, turns);
    out.child(node, "car body", {{"mesh", body_of(number * 5 % kinds_.size(), group)}});
    const dusk::Car& car = kind.car;
    for (double side : {-1.0, 1.0})
      for (double z : {car.front_axle, car.back_axle}) {
        const int wheel =
            out.child(node, "wheel",
                      {{"mesh", kind.right_wheel}, {"translation", vector_json({side * car.wheel_x, car.wheel_m, z})}});
        play(out, side < 0 ? kind.left_turn : kind.right_turn, wheel, "rotation");
      }
    LightArrays head, tail;
    for (double x : {-1.0, 1.0}) {
      head.add({x * car.head_x, car.head_y, car.front_z - 0.15}, {1, 0.93, 0.8}, 320, 34, {0, 1, 0});
      head.aim({0.02 * x, -0.11, -1});
      tail.add({x * car.tail_x, car.tail_y, car.back_z + 0.2}, {1, 0.04, 0.02}, 9, 8, {0, 1, 0});
      tail.aim({0, -0.35, 1});
    }
    out.child(node, "head lamps", {{"extensions", head.extension(out, heads_[group])}});
    out.child(node, "tail lamps", {{"extensions", tail.extension(out, tails_[group])}});
  }

  int body_of(size_t kind, size_t group) {
    int& mesh = bodies_[{kind, group}];
    if (mesh == 0) mesh = town_.switches.mesh_with(kinds_[kind].car.mesh, town_.m.glows, glows_[group]);
    return mesh;
  }

  // Along kerbs, away from crossings.
  void add_parked() {
    std::vector<int> parked;
    for (glm::dvec3 color : {glm::dvec3(0.02, 0.05, 0.04), glm::dvec3(0.2, 0.21, 0.22), glm::dvec3(0.18, 0.05, 0.03)})
      parked.push_back(
          make_car(town_.out, town_.m, parked.size() == 1 ? dusk::saloon : dusk::hatchback, color, false).mesh);
    for (int c = 0; c < block_columns; ++c)
      for (int r = 0; r < block_rows; ++r)
        for (int side = 0; side < 4; ++side)
          for (double x : {-12.0, -6.0, 6.0, 12.0}) {
            const uint64_t which = town_.rng.next() % 12;
            if (which >= parked.size()) continue;
            const glm::dvec2 centre = block_centre(c, r);
            const glm::dmat4 frame = placed({centre.x, 0, centre.y}, side * pi / 2);
            // The middle of the block is on their right, as it is of those that drive.
            town_.instances.add(parked[which], glm::dvec3(frame * glm::dvec4(x, 0, pad_half_m + 1.05, 1)),
                                side * pi / 2 + pi / 2);
          }
  }

  Town& town_;
  std::vector<Way> ways_;
  std::vector<Drive> drives_;
  std::vector<Kind> kinds_;
  std::vector<int> glows_, heads_, tails_;
  std::map<std::pair<size_t, size_t>, int> bodies_;
};

}  // namespace

void add_city_cars(Town& town) { Cars(town).make(); }

}  // namespace candela::city
