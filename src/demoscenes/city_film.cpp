#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"
#include "math/transforms.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

// The sun, and three shots of one camera: down from the roofs, along the street, on the square.
namespace candela::city {
namespace {

using std::numbers::pi;
constexpr double rad = pi / 180;

struct View {
  glm::dvec3 eye, target;
  double yfov_deg;
};
struct Shot {
  double from_s, to_s;
  View first, last;
};
constexpr std::array<Shot, 3> shots{
    {{0, first_cut_s, {{-4.5, 21, 66}, {6, 7, -30}, 42}, {{-2.4, 10.6, 45}, {3.5, 7.6, -30}, 45}},
     {first_cut_s, second_cut_s, {{8.15, 1.6, 12.6}, {6.9, 2.6, -8}, 45}, {{8.3, 1.6, 6.6}, {8.2, 1.9, -10}, 37}},
     {second_cut_s, end_s, {{7.3, 1.7, -6.9}, {24, 6.3, -21}, 52}, {{8.3, 1.8, -7.7}, {24, 7.4, -21}, 56}}}};

View view_at(const Shot& shot, double t) {
  const double u = std::clamp((t - shot.from_s) / (shot.to_s - shot.from_s), 0.0, 1.0);
  const double s = 0.5 * u + 0.5 * u * u * (3 - 2 * u);
  return {glm::mix(shot.first.eye, shot.last.eye, s), glm::mix(shot.first.target, shot.last.target, s),
          shot.first.yfov_deg + (shot.last.yfov_deg - shot.first.yfov_deg) * s};
}

const Shot& shot_at(double time_s) {
  const auto shot = std::ranges::find_if(shots, [&](const Shot& s) { return time_s < s.to_s; });
  return shot == shots.end() ? shots.back() : *shot;
}

void add_camera(GlbWriter& out) {
  const int camera = out.camera(
      {{"type", "perspective"}, {"perspective", {{"yfov", number(shots[0].first.yfov_deg * rad)}, {"znear", 0.1}}}});
  // The shot's node steps, which says where cuts are; below it the camera goes on until just before each.
  const int shot_node = out.node("shot", {{"translation", vector_json(shots[0].first.eye)}});
  const int node = out.child(shot_node, "camera", {{"camera", camera}});
  std::vector<double> shot_times, shot_places, times, fields;
  std::vector<glm::dvec3> places;
  std::vector<glm::dquat> turns;
  for (const Shot& shot : shots) {
    shot_times.push_back(shot.from_s);
    push(shot_places, shot.first.eye);
    const bool is_last = shot.to_s == end_s;
    for (int k = int(std::lround(shot.from_s * frames_per_s)); k <= int(std::lround(shot.to_s * frames_per_s)); ++k) {
      const bool cut = k == int(std::lround(shot.to_s * frames_per_s)) && !is_last;
      const double t = k / frames_per_s - (cut ? 1e-4 : 0);
      const View view = view_at(shot, t);
      times.push_back(t);
      places.push_back(view.eye - shot.first.eye);
      turns.push_back(glm::quat_cast(glm::dmat3(look_at_pose(view.eye, view.target))));
      fields.push_back(view.yfov_deg * rad);
    }
  }
  out.animate(shot_node, "translation", "STEP", shot_times, shot_places, 3);
  animate_places(out, node, times, places);
  animate_turns(out, node, times, turns);
  out.animate_pointer(fmt::format("/cameras/{}/perspective/yfov", camera), "LINEAR", times, fields, 1);
}

void add_sunlight(GlbWriter& out) {
  const int light = out.light({{"name", "sun"}, {"type", "directional"}, {"intensity", 10}});
  const int node = out.node("sun", {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  std::vector<double> times, colors, lux;
  std::vector<glm::dquat> turns;
  for (double t = 0; t <= 10.51; t += 0.125) {
    const double elevation = sun_elevation_deg(t);
    times.push_back(t);
    turns.push_back(glm::quat_cast(glm::dmat3(look_at_pose(sun_direction(t), {0, 0, 0}))));
    // What air leaves of it: the lower, the less and the redder.
    const double air = 1 / (std::sin(std::max(elevation, 0.0) * rad) + 0.11);
    const glm::dvec3 left = glm::exp(-glm::dvec3(0.065, 0.2, 0.46) * air);
    const double most = std::max({left.x, left.y, left.z});
    push(colors, left / most);
    // Gone before it comes out once more, for four frames, at the end of the avenue: that would be a flash.
    lux.push_back(40 * most * smooth_step(2.5, 8, elevation));
  }
  animate_turns(out, node, times, turns);
  const std::string pointer = fmt::format("/extensions/KHR_lights_punctual/lights/{}/", light);
  out.animate_pointer(pointer + "color", "LINEAR", times, colors, 3);
  out.animate_pointer(pointer + "intensity", "LINEAR", times, lux, 1);
}

}  // namespace

double sun_elevation_deg(double time_s) {
  const double u = std::clamp((time_s - sun_from_s) / (sun_to_s - sun_from_s), 0.0, 1.0);
  return sun_from_deg + (sun_to_deg - sun_from_deg) * u;
}

glm::dvec3 sun_direction(double time_s) {
  const double u = std::clamp((time_s - sun_from_s) / (sun_to_s - sun_from_s), 0.0, 1.0);
  const double elevation = sun_elevation_deg(time_s) * rad, azimuth = (-72 + 100 * u) * rad;  // from -Z to +X
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)};
}

glm::dvec3 camera_at(double time_s) { return view_at(shot_at(time_s), time_s).eye; }
glm::dvec3 camera_target(double time_s) { return view_at(shot_at(time_s), time_s).target; }

void add_city_film(Town& town) {
  add_sunlight(town.out);
  add_camera(town.out);
}

}  // namespace candela::city
