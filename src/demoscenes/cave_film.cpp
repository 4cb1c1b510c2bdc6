#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/cave.h"
#include "math/transforms.h"
#include "testscenes/table.h"

// Lamps and camera.
namespace candela::cave {
namespace {

using std::numbers::pi;
constexpr double rad = pi / 180;

// A uniform cubic B-spline's span.
glm::dvec3 spline(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d, double t) {
  const double s = 1 - t, t2 = t * t, t3 = t2 * t;
  return (s * s * s * a + (3 * t3 - 6 * t2 + 4) * b + (-3 * t3 + 3 * t2 + 3 * t + 1) * c + t3 * d) / 6.0;
}
// Open, from the first point to the last one.
glm::dvec3 open_spline(std::span<const glm::dvec3> points, double share) {
  const int n = int(points.size());
  const auto at = [&](int i) { return points[size_t(std::clamp(i, 0, n - 1))]; };
  const double x = std::clamp(share, 0.0, 1.0) * (n + 1);
  const int k = std::min(int(x), n);
  return spline(at(k - 2), at(k - 1), at(k), at(k + 1), x - k);
}

struct Shot {
  double from_s, to_s;
  std::vector<glm::dvec3> eyes, targets;
  double first_fov_deg, last_fov_deg;
};
const std::array<Shot, 3>& shots() {
  static const std::array<Shot, 3> all{{{0,
                                         first_cut_s,
                                         {{1.5, 1.75, 9.2}, {1.1, 1.6, 7}, {0.7, 1.55, 5}, {1.2, 1.6, 3.4}},
                                         {{0.2, 1.7, -4}, {-0.6, 1.7, -4}, {-0.6, 1.6, -4}},
                                         50,
                                         48},
                                        {first_cut_s,
                                         second_cut_s,
                                         {{1.5, 1.6, -4.4}, {1.9, 1.5, -4.8}, {2.6, 1.5, -5.2}},
                                         {{3.4, 1.9, -8.5}, {3.7, 1.8, -8.5}, {4, 1.7, -8.5}},
                                         46,
                                         46},
                                        {second_cut_s,
                                         end_s,
                                         {{-1.5, 2.9, -2.9}, {-1, 2.4, -2.2}, {-0.4, 1.8, -0.2}, {0.7, 1.6, 1.8}},
                                         {{-3.6, 3.4, -5.3}, {-3.4, 2.9, -5.2}, {-2, 1.9, -4.4}, {-0.9, 1.5, -3.8}},
                                         46,
                                         48}}};
  return all;
}

void add_camera(GlbWriter& out) {
  const int camera = out.camera(
      {{"type", "perspective"}, {"perspective", {{"yfov", number(shots()[0].first_fov_deg * rad)}, {"znear", 0.05}}}});
  // The shot's node steps, which says where cuts are; below it the camera goes on until just before each.
  const int shot_node = out.node("shot", {{"translation", vector_json(shots()[0].eyes[0])}});
  const int node = out.child(shot_node, "camera", {{"camera", camera}});
  std::vector<double> shot_times, shot_places, times, fields, places, turns;
  for (const Shot& shot : shots()) {
    shot_times.push_back(shot.from_s);
    push(shot_places, shot.eyes[0]);
    const int last = int(std::lround(shot.to_s * frames_per_s));
    for (int k = int(std::lround(shot.from_s * frames_per_s)); k <= last; ++k) {
      const bool cut = k == last && shot.to_s != end_s;
      const double t = k / frames_per_s - (cut ? 1e-4 : 0);
      const double u = std::clamp((t - shot.from_s) / (shot.to_s - shot.from_s), 0.0, 1.0);
      const double share = 0.12 + 0.8 * (0.7 * u + 0.3 * u * u * (3 - 2 * u));
      const glm::dvec3 eye = open_spline(shot.eyes, share), target = open_spline(shot.targets, share);
      times.push_back(t);
      push(places, eye - shot.eyes[0]);
      push(turns, glm::quat_cast(glm::dmat3(look_at_pose(eye, target))));
      fields.push_back((shot.first_fov_deg + (shot.last_fov_deg - shot.first_fov_deg) * u) * rad);
    }
  }
  out.animate(shot_node, "translation", "STEP", shot_times, shot_places, 3);
  out.animate(node, "translation", "LINEAR", times, places, 3);
  out.animate(node, "rotation", "LINEAR", times, turns, 4);
  out.animate_pointer(fmt::format("/cameras/{}/perspective/yfov", camera), "LINEAR", times, fields, 1);
}

void add_lamps(GlbWriter& out) {
  out.use_extension("KHR_materials_emissive_strength");
  const json ball = out.primitive(sphere(lamp_radius_m, 24, 14));
  for (const Lamp& lamp : lamps()) {
    json glow = pbr({0.02, 0.02, 0.02, 1}, 0, 0.6);
    glow["emissiveFactor"] = vector_json(lamp.color);
    glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 3;
    const int mesh = out.mesh(lamp.name, ball, out.material(lamp.name, glow));
    const int light = out.light({{"type", "point"},
                                 {"name", lamp.name},
                                 {"color", vector_json(lamp.color)},
                                 {"intensity", number(lamp.candela)},
                                 {"range", 14}});
    out.node(lamp.name, {{"translation", vector_json(lamp_at(lamp, 0))},
                         {"mesh", mesh},
                         {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
}

void add_daylight(GlbWriter& out) {
  // What is seen of the sky from below.
  json sky = pbr({0, 0, 0, 1}, 0, 1);
  sky["emissiveFactor"] = vector_json({1, 0.92, 0.78});
  sky["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 4;
  sky["doubleSided"] = true;
  out.node("sky", {{"mesh", out.mesh("sky", out.primitive(ground(2.4, 1, 1)), out.material("sky", sky))},
                   {"translation", vector_json(shaft_top + glm::dvec3(0, 0.5, 0))}});
  const int light = out.light({{"name", "daylight"},
                               {"type", "spot"},
                               {"color", vector_json({1, 0.88, 0.66})},
                               {"intensity", 700},
                               {"range", 16},
                               {"spot", {{"innerConeAngle", 0.12}, {"outerConeAngle", 0.17}}}});
  const glm::dquat turn = glm::quat_cast(glm::dmat3(look_at_pose(shaft_top, {island.x, 0.7, island.y})));
  out.node("daylight", {{"translation", vector_json(shaft_top)},
                        {"rotation", quaternion_json(turn)},
                        {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  // What pool and island throw back of it onto the bunny, from below.
  const int bounce = out.light({{"name", "bounce"},
                                {"type", "spot"},
                                {"color", vector_json({1, 0.86, 0.68})},
                                {"intensity", 4},
                                {"range", 4.5},
                                {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}});
  const glm::dvec3 from(1.2, 0.05, -0.1);
  const glm::dquat up = glm::quat_cast(glm::dmat3(look_at_pose(from, {island.x, 1.0, island.y})));
  out.node("bounce", {{"translation", vector_json(from)},
                      {"rotation", quaternion_json(up)},
                      {"extensions", {{"KHR_lights_punctual", {{"light", bounce}}}}}});
}

}  // namespace

// At first they are about the hall, then they pass along the wall while the second shot looks at it, and come to the
// dragon and the bunny.
const std::array<Lamp, 3>& lamps() {
  static const std::array<Lamp, 3> all{{{"Amber",
                                         "-amber",
                                         {1, 0.4, 0.08},
                                         26,
                                         {{-1.2, 1.9, -3.6},
                                          {-2.2, 2.3, -4.2},
                                          {-1.2, 2.7, -6},
                                          {1.2, 2, -7.4},
                                          {2.7, 1.6, -8.3},
                                          {4, 1.3, -7.7},
                                          {4.4, 2, -6.8},
                                          {1.6, 2.8, -6.6},
                                          {-0.6, 2.5, -5.6},
                                          {-2.2, 2.9, -4.4}},
                                         {{0, 0},
                                          {2, 1},
                                          {3.5, 2},
                                          {4.8, 3},
                                          {5.4, 4},
                                          {6.3, 5},
                                          {7, 6},
                                          {8, 7},
                                          {9, 8},
                                          {9.9, 9},
                                          {11.7, 10},
                                          {13, 11},
                                          {15, 11.6}}},
                                        {"Azure",
                                         "-azure",
                                         {0.08, 0.38, 1},
                                         30,
                                         {{2.4, 1.4, 0.6},
                                          {1.4, 1.3, -0.9},
                                          {-0.9, 1.3, -1},
                                          {-1, 1.5, -3.6},
                                          {1, 2, -6.6},
                                          {3.4, 2.4, -7.7},
                                          {5, 2.3, -7.3},
                                          {3.9, 1.9, -7.9},
                                          {2.7, 1.2, -8.2},
                                          {3.8, 1.4, -6.9},
                                          {2.6, 1.2, -3.6},
                                          {1.6, 1, -3.6}},
                                         {{0, 0},
                                          {1.6, 1},
                                          {2.8, 2},
                                          {4, 3},
                                          {4.8, 4},
                                          {5.6, 5},
                                          {6.6, 6},
                                          {7.5, 7},
                                          {8.4, 8},
                                          {9.5, 9},
                                          {11, 10},
                                          {12.4, 11},
                                          {15, 11.7}}},
                                        {"Rose",
                                         "-rose",
                                         {1, 0.07, 0.3},
                                         26,
                                         {{-3.3, 1.5, -1.8},
                                          {-3.3, 1.4, -3.4},
                                          {-1.8, 1.1, -4.6},
                                          {0.2, 0.9, -5.6},
                                          {2.2, 1, -6.6},
                                          {3.2, 0.9, -7.9},
                                          {4.5, 1.1, -7.2},
                                          {4.9, 1.9, -6.2},
                                          {2.8, 2.2, -5},
                                          {0.4, 1.6, -4.6},
                                          {-1.6, 1.3, -3.6},
                                          {-2.6, 1.4, -2.2}},
                                         {{0, 0},
                                          {1.5, 1},
                                          {3, 2},
                                          {4, 3},
                                          {5, 4},
                                          {6.6, 5},
                                          {7.8, 6},
                                          {9, 7},
                                          {10.2, 8},
                                          {11.5, 9},
                                          {13, 10},
                                          {15, 11.3}}}}};
  return all;
}

glm::dvec3 lamp_at(const Lamp& lamp, double parameter) {
  const int n = int(lamp.points.size()), k = int(std::floor(parameter));
  const auto at = [&](int i) { return lamp.points[size_t(((i % n) + n) % n)]; };
  // At k it is nearest to point k.
  return spline(at(k - 1), at(k), at(k + 1), at(k + 2), parameter - k);
}

void add_film(GlbWriter& out) {
  add_lamps(out);
  add_daylight(out);
  add_camera(out);
}

}  // namespace candela::cave
