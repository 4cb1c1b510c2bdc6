#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/cave.h"

// Rocks and dripstones: a few meshes, drawn where files say (docs/using/paths.md).
namespace candela::cave {
namespace {

using std::numbers::pi;

// A ball cut by planes, weathered.
double boulder(glm::dvec3 p, uint64_t seed, glm::dvec3 stretch) {
  p /= stretch;
  Rng rng(seed);
  double d = glm::length(p) - 0.56;
  for (int i = 0; i < 11; ++i) {
    const double y = rng.uniform(-1, 1), a = rng.uniform(0, 2 * pi), r = std::sqrt(1 - y * y);
    d = smooth_max(d, glm::dot(p, glm::dvec3(r * std::cos(a), y, r * std::sin(a))) - rng.uniform(0.33, 0.5), 0.07);
  }
  d += 0.05 * fbm3(p * 3.0, 3, seed) + 0.03 * (0.6 - ridged3(p * 4.0, 2, seed + 5));
  return d * std::min({stretch.x, stretch.y, stretch.z});
}

// From 0.3 m above the origin `long_m` down, with rings of growth.
double drip(glm::dvec3 p, double long_m, double thick_m, uint64_t seed) {
  const double bend = 0.1 * std::sin(1.7 * p.y + double(seed));
  p.x += bend * std::min(-p.y, 1.0) * 0.5;
  const double down = std::clamp(-p.y / long_m, -0.3, 1.0);
  double radius =
      thick_m * std::pow(1 - std::max(down, 0.0), 0.8) + thick_m * 0.9 * std::pow(std::max(0.3 - down, 0.0), 2) * 4;
  radius *= 1 + 0.16 * noise3({p.y * 6, double(seed), 0}, seed) + 0.25 * noise3(p * glm::dvec3(4, 0.7, 4), seed + 3);
  const double across = glm::length(glm::dvec2(p.x, p.z)) - radius;
  return std::max({across * 0.8, -p.y - long_m, p.y - 0.32});
}

struct Kind {
  const char *node, *suffix;
  bool hangs, drips;
  double cell_m;
  glm::dvec3 reach_low, reach_high;
  double (*field)(glm::dvec3);
};

const std::array<Kind, 8>& kinds() {
  static const std::array<Kind, 8> all{{
      {"Boulder 1",
       "-boulders-1.txt",
       false,
       false,
       0.15,
       {-0.9, -0.7, -0.9},
       {0.9, 0.7, 0.9},
       [](glm::dvec3 p) {
         return boulder(p, 11, {1.2, 0.8, 1});
       }},
      {"Boulder 2",
       "-boulders-2.txt",
       false,
       false,
       0.15,
       {-0.9, -0.8, -0.9},
       {0.9, 0.8, 0.9},
       [](glm::dvec3 p) {
         return boulder(p, 12, {0.9, 1.1, 1});
       }},
      {"Boulder 3",
       "-boulders-3.txt",
       false,
       false,
       0.15,
       {-1, -0.6, -1},
       {1, 0.6, 1},
       [](glm::dvec3 p) {
         return boulder(p, 13, {1.35, 0.6, 1.1});
       }},
      {"Pebble",
       "-pebbles.txt",
       false,
       false,
       0.28,
       {-0.9, -0.8, -0.9},
       {0.9, 0.8, 0.9},
       [](glm::dvec3 p) {
         return boulder(p, 14, {1.1, 0.75, 1});
       }},
      {"Dripstone 1",
       "-dripstones-1.txt",
       true,
       true,
       0.115,
       {-0.7, -2.1, -0.7},
       {0.7, 0.5, 0.7},
       [](glm::dvec3 p) { return drip(p, 1.9, 0.2, 3); }},
      {"Dripstone 2",
       "-dripstones-2.txt",
       true,
       true,
       0.115,
       {-0.9, -1.7, -0.9},
       {0.9, 0.5, 0.9},
       [](glm::dvec3 p) {
         double d = drip(p, 1.4, 0.17, 5);
         d = smooth_min(d, drip(p - glm::dvec3(0.27, 0, 0.1), 0.9, 0.12, 6), 0.12);
         return smooth_min(d, drip(p - glm::dvec3(-0.15, 0, 0.24), 0.6, 0.11, 7), 0.12);
       }},
      {"Dripstone 3",
       "-dripstones-3.txt",
       true,
       true,
       0.09,
       {-0.5, -1.2, -0.5},
       {0.5, 0.5, 0.5},
       [](glm::dvec3 p) { return drip(p, 1.0, 0.1, 8); }},
      {"Standing dripstone",
       "-standing.txt",
       false,
       true,
       0.12,
       {-0.9, -0.5, -0.9},
       {0.9, 1.5, 0.9},
       [](glm::dvec3 p) { return drip(glm::dvec3(p.x, -p.y, p.z), 1.2, 0.26, 9); }},
  }};
  return all;
}

// Nothing stands where the camera, the beasts or the lamps are.
bool is_kept_clear(glm::dvec2 at) {
  const auto near = [&](glm::dvec2 from, glm::dvec2 to, double away) {
    const glm::dvec2 way = to - from;
    const double t = std::clamp(glm::dot(at - from, way) / std::max(glm::dot(way, way), 1e-9), 0.0, 1.0);
    return glm::length(at - from - way * t) < away;
  };
  return near({1.3, 10}, {0.6, 1.5}, 1.1) || near(island, island, 1.7) || near(ledge, ledge, 3.4) ||
         near({1.3, -4}, {3.6, -6.5}, 1.3) || near({2.4, -8.7}, {5.4, -7.3}, 0.9) || near({-2.5, -3.2}, {0.7, 2}, 1.3);
}

// Whether a lamp comes within `away_m` of a post that stands at `at` between two heights.
bool meets_a_lamp(glm::dvec2 at, double low, double high, double away_m) {
  static const std::vector<glm::dvec3> ways = [] {
    std::vector<glm::dvec3> points;
    for (const Lamp& lamp : lamps())
      for (int i = 0; i < 32 * int(lamp.points.size()); ++i) points.push_back(lamp_at(lamp, i / 32.0));
    return points;
  }();
  return std::ranges::any_of(ways, [&](glm::dvec3 p) {
    const glm::dvec3 nearest(at.x, std::clamp(p.y, low, high), at.y);
    return glm::distance(p, nearest) < away_m;
  });
}

// Where rock begins from `from` along the vertical, or NaN.
double meet(glm::dvec3 from, double way) {
  for (int i = 0; i < 200; ++i, from.y += way * 0.06)
    if (air(from) > 0) return from.y;
  return std::nan("");
}

}  // namespace

std::vector<Stones> place_stones(uint64_t seed) {
  std::vector<Stones> out;
  for (const Kind& kind : kinds()) out.push_back({kind.node, kind.suffix, {}});
  Rng rng(seed * 31 + 7);
  const auto turn = [&] { return std::floor(rng.uniform(0, 360)); };
  // Rocks lie at the foot of the walls, pebbles about them.
  for (int i = 0; i < 2600 && out[0].places.size() + out[1].places.size() + out[2].places.size() < 90; ++i) {
    const glm::dvec2 at(rng.uniform(-7.5, 7.5), rng.uniform(-11, 11.5));
    const double size = rng.uniform(0.45, 1.25);
    if (air({at.x, 1.1, at.y}) > -0.25 || air({at.x, 1.1, at.y}) < -1.5 || is_kept_clear(at)) continue;
    const double floor = meet({at.x, 1.1, at.y}, -1);
    if (std::isnan(floor) || floor < water_m - 0.1 || meets_a_lamp(at, floor, floor + 0.5 * size, 0.6 * size + 0.35))
      continue;
    const glm::dvec3 scale = size * glm::dvec3(rng.uniform(0.8, 1.2), rng.uniform(0.75, 1.1), rng.uniform(0.8, 1.2));
    out[size_t(i % 3)].places.push_back(
        {scale, {rng.uniform(-14, 14), turn(), rng.uniform(-14, 14)}, {at.x, floor + 0.1 * size, at.y}});
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 beside = at + glm::dvec2(rng.uniform(-1.2, 1.2), rng.uniform(-1.2, 1.2));
      if (air({beside.x, 1.1, beside.y}) > -0.1 || is_kept_clear(beside)) continue;
      const double foot = meet({beside.x, 1.1, beside.y}, -1);
      if (!std::isnan(foot))
        out[3].places.push_back({glm::dvec3(rng.uniform(0.1, 0.34)),
                                 {rng.uniform(-30, 30), turn(), rng.uniform(-30, 30)},
                                 {beside.x, foot + 0.02, beside.y}});
    }
  }
  // Dripstones hang in groups, and some have one that stands below them.
  for (int i = 0; i < 120; ++i) {
    const glm::dvec2 at(rng.uniform(-6.5, 6.5), rng.uniform(-10.5, 10));
    const bool in_shaft = glm::length(at - glm::dvec2(0.8, -1.2)) < 2.3;
    if (air({at.x, 2.2, at.y}) > -0.5 || in_shaft) continue;
    const double top = meet({at.x, 2.2, at.y}, 1);
    if (std::isnan(top) || top < 3.1) continue;
    const int together = 2 + int(rng.uniform(0, 4));
    for (int k = 0; k < together; ++k) {
      const glm::dvec2 beside = at + glm::dvec2(rng.uniform(-0.7, 0.7), rng.uniform(-0.7, 0.7)) * double(k > 0);
      if (air({beside.x, 2.2, beside.y}) > -0.2) continue;
      const double ceiling = meet({beside.x, 2.2, beside.y}, 1);
      if (std::isnan(ceiling) || ceiling < 2.8) continue;
      const double most = std::min((ceiling - 2.3) / 1.9, 1.35), size = most * rng.uniform(0.45, 1);
      if (meets_a_lamp(beside, ceiling - 2.3 * size, ceiling, 0.35 + 0.3 * size)) continue;
      out[size_t(4 + (i + k) % 3)].places.push_back({{size, size * rng.uniform(0.9, 1.2), size},
                                                     {rng.uniform(-4, 4), turn(), rng.uniform(-4, 4)},
                                                     {beside.x, ceiling + 0.16 * size, beside.y}});
    }
    if (i % 3 != 0 || is_kept_clear(at)) continue;
    const double floor = meet({at.x, 1.6, at.y}, -1);
    if (std::isnan(floor) || floor < water_m - 0.3) continue;
    const double size = rng.uniform(0.6, 1.3);
    if (meets_a_lamp(at, floor, floor + 1.6 * size, 0.4 * size + 0.3)) continue;
    out[7].places.push_back({{size, size * rng.uniform(0.8, 1.3), size},
                             {rng.uniform(-4, 4), turn(), rng.uniform(-4, 4)},
                             {at.x, floor - 0.02, at.y}});
  }
  return out;
}

void add_stones(GlbWriter& out, int rock_material) {
  for (const Kind& kind : kinds()) {
    const ImplicitMesh mesh = mesh_implicit(kind.field, kind.reach_low, kind.reach_high, kind.cell_m, 2);
    const bool drips = kind.drips;
    const Shape shape = textured(mesh, {[](glm::dvec3, glm::dvec3 n) { return box_group(n); },
                                        [](glm::dvec3 at, glm::dvec3, int group) { return box_uv(at, group) / 2.0; },
                                        [drips](glm::dvec3 p, glm::dvec3) {
                                          const double v = fbm3(p * 2.0, 3, 50);
                                          return drips ? glm::dvec3(1.12, 1.0, 0.86) * (0.95 + 0.4 * v)
                                                       : glm::dvec3(0.9, 0.88, 0.86) * (0.8 + 0.5 * v);
                                        }});
    out.node(kind.node, {{"mesh", out.mesh(kind.node, out.primitive(shape), rock_material)}});
  }
}

}  // namespace candela::cave
