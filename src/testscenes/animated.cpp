#include <array>
#include <cmath>
#include <numbers>

#include "math/transforms.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {

namespace {

using std::numbers::pi;
constexpr double period_s = 4;  // everything is back where it began

constexpr std::array<glm::dvec3, 6> lantern_colors{
    {{1, 0.55, 0.2}, {0.3, 0.6, 1}, {1, 0.3, 0.35}, {0.35, 1, 0.6}, {0.85, 0.4, 1}, {1, 0.85, 0.4}}};

// 0 on the joints between 2 x 2 stone tiles, 1 on the tiles.
double tile_height(double u, double v) {
  const auto edge = [](double x) {
    const double f = x * 2 - std::floor(x * 2);
    return smooth_step(0.01, 0.06, std::min(f, 1 - f));
  };
  return edge(u) * edge(v);
}

// A full turn about +Y in `steps` keys; LINEAR between them, or STEP for a clock's jump.
void animate_turn(GlbWriter& out, int node, int steps, double turns, std::string_view interpolation) {
  std::vector<double> times, values;
  for (int i = 0; i <= steps; ++i) {
    times.push_back(period_s * i / steps);
    push(values, rotation_about({0, 1, 0}, 2 * pi * turns * i / steps));
  }
  out.animate(node, "rotation", interpolation, times, values, 4);
}

// Geometry that several objects share, scaled by their nodes: it is most of the file.
struct AnimatedParts {
  json ball;    // radius 1
  json column;  // height 3.4
};

void add_floor_and_sky(GlbWriter& out, SceneOptions& options, const AnimatedParts& parts) {
  const uint64_t seed = options.rng.next() >> 32;
  const int tiles = out.texture("tiles", png_from(64, 64, 3, [seed](double u, double v) {
                                  const double tone = 0.12 * double(((int(u * 2) + int(v * 2)) % 2)) +
                                                      0.1 * std::round(8 * tiling_noise(u, v, 8, seed)) / 8;
                                  const glm::dvec3 stone = glm::dvec3(0.5, 0.46, 0.42) + tone, joint(0.2, 0.18, 0.17);
                                  return glm::dvec4(glm::mix(joint, stone, tile_height(u, v)), 1);
                                }));
  const int relief = out.texture("tile relief", normal_map_from(64, 16, [](double u, double v) {
                                   return 0.06 * tile_height(u, v) +
                                          0.008 * std::sin(2 * pi * (3 * u + v)) * std::sin(2 * pi * (2 * v - u));
                                 }));
  json material = pbr_textured(tiles, 0, 0.38);
  material["normalTexture"] = {{"index", relief}};
  out.node("floor", {{"mesh", out.mesh("floor", out.primitive(ground(28, 1, 14)), out.material("tiles", material))}});

  out.use_extension("KHR_materials_unlit");
  const int dusk =
      out.texture("dusk",
                  png_from(4, 64, 3,
                           [](double, double v) {
                             const double up = std::clamp(1 - 2 * v, 0.0, 1.0);  // 0 at the horizon, 1 overhead
                             const glm::dvec3 glow(0.86, 0.42, 0.22), rose(0.45, 0.22, 0.38), night(0.05, 0.06, 0.16);
                             return glm::dvec4(up < 0.25 ? glm::mix(glow, rose, up / 0.25)
                                                         : glm::mix(rose, night, smooth_step(0.25, 0.8, up)),
                                               1);
                           }),
                  {{"wrapT", 33071}});
  json sky = pbr_textured(dusk, 0, 1);
  sky["extensions"]["KHR_materials_unlit"] = json::object();
  sky["doubleSided"] = true;  // seen from inside
  out.node("sky",
           {{"mesh", out.mesh("sky", parts.ball, out.material("dusk", sky))}, {"scale", vector_json({60, 60, 60})}});

  Shape stars;
  for (int i = 0; i < 150; ++i) {
    const double y = options.rng.uniform(0.15, 0.9), angle = options.rng.uniform(0, 2 * pi), r = std::sqrt(1 - y * y);
    stars.position.push_back(58.0 * glm::dvec3(r * std::cos(angle), y, r * std::sin(angle)));
    stars.color.emplace_back(glm::dvec3(options.rng.uniform(0.2, 1)), 1);
  }
  json star = pbr({1, 1, 0.95, 1}, 0, 1);
  star["extensions"]["KHR_materials_unlit"] = json::object();
  json points = out.primitive(stars);
  points["mode"] = 0;
  out.node("stars", {{"mesh", out.mesh("stars", points, out.material("star", star))}});
}

void add_columns(GlbWriter& out, const AnimatedParts& parts) {
  const int marble =
      out.texture("marble", png_from(32, 32, 3, [](double u, double v) {
                    const double flute = 0.5 + 0.5 * std::cos(2 * pi * 6 * u),
                                 vein = std::pow(0.5 + 0.5 * std::sin(2 * pi * (v + 0.3 * std::sin(2 * pi * u))), 6);
                    return glm::dvec4(glm::dvec3(0.82, 0.78, 0.72) - 0.22 * (1 - flute) - 0.15 * vein, 1);
                  }));
  const int mesh = out.mesh("column", parts.column, out.material("marble", pbr_textured(marble, 0, 0.5)));
  // An arc that is open towards the camera.
  for (int i = 0; i < 9; ++i) {
    const double angle = pi * (0.92 + 1.16 * i / 8);
    out.node("column",
             {{"mesh", mesh}, {"translation", vector_json({5.2 * std::cos(angle), 0, 5.2 * std::sin(angle)})}});
  }
}

void add_lanterns(GlbWriter& out, SceneOptions& options, const AnimatedParts& parts) {
  out.use_extension("KHR_materials_emissive_strength");
  const bool scattered = options.lights > 0;
  const int count = scattered ? options.lights : int(lantern_colors.size());
  const double bulb_radius = scattered ? 0.05 : 0.14;
  std::vector<int> meshes, lights;
  for (glm::dvec3 color : lantern_colors) {
    json material = pbr({0, 0, 0, 1}, 0, 1);
    material["emissiveFactor"] = vector_json(color);
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 4}};
    meshes.push_back(out.mesh("bulb", parts.ball, out.material("glow", material)));
    json light = {
        {"type", "point"}, {"color", vector_json(color)}, {"intensity", number(scattered ? 70.0 / count : 9)}};
    if (scattered) light["range"] = 3;
    lights.push_back(out.light(light));
  }
  const int ring = out.node("lanterns", json::object());
  for (int i = 0; i < count; ++i) {
    const size_t color = size_t(i) % lantern_colors.size();
    const double angle = scattered ? options.rng.uniform(0, 2 * pi) : 2 * pi * i / count;
    const double radius = scattered ? 9 * std::sqrt(options.rng.uniform()) : 3.4;
    const double height = scattered ? options.rng.uniform(0.1, 2.5) : 1.5;
    out.child(ring, "lantern",
              {{"mesh", meshes[color]},
               {"translation", vector_json({radius * std::cos(angle), height, radius * std::sin(angle)})},
               {"scale", vector_json(glm::dvec3(bulb_radius))},
               {"extensions", {{"KHR_lights_punctual", {{"light", lights[color]}}}}}});
  }
  animate_turn(out, ring, 12, 1.0 / 6, "LINEAR");  // a sixth of a turn: the colours move on by one lantern
}

// The centre: a woven ring that turns about a polished ball, both above a plinth.
void add_centrepiece(GlbWriter& out, const AnimatedParts& parts) {
  const int weave =
      out.texture("weave", png_from(48, 48, 3, [](double u, double v) {
                    const bool over = (int(u * 6) + int(v * 6)) % 2 != 0;
                    const double across = over ? v * 6 - std::floor(v * 6) : u * 6 - std::floor(u * 6);
                    const double round = std::sin(pi * across);
                    return glm::dvec4(
                        (over ? glm::dvec3(0.95, 0.62, 0.2) : glm::dvec3(0.65, 0.16, 0.12)) * (0.45 + 0.55 * round), 1);
                  }));
  const int stone = out.material("dark stone", pbr({0.12, 0.13, 0.16, 1}, 0, 0.3));
  out.node("plinth", {{"mesh", out.mesh("plinth", parts.column, stone)}, {"scale", vector_json({2.3, 0.235, 2.3})}});
  const int pivot = out.node("pivot", {{"translation", vector_json({0, 1.9, 0})}});
  const int tilt = out.child(pivot, "tilt", {{"rotation", quaternion_json(rotation_about({1, 0, 0.3}, 1.1))}});
  const int ring = out.mesh("ring", out.primitive(torus(0.85, 0.2, 24, 9, {12, 3})),
                            out.material("weave", pbr_textured(weave, 0, 0.45)));
  const int spin = out.child(tilt, "ring", {{"mesh", ring}});
  animate_turn(out, pivot, 8, 1, "LINEAR");
  animate_turn(out, spin, 8, -1, "LINEAR");
  const int ball = out.mesh("ball", parts.ball, out.material("polished", pbr({0.95, 0.93, 0.88, 1}, 1, 0.36)));
  const int core = out.node("ball", {{"mesh", ball}, {"translation", vector_json({0, 1.9, 0})}});
  // It breathes: cubic splines with flat tangents, so in-tangent, value, out-tangent for each key.
  std::vector<double> scales;
  for (double s : {1.0, 1.25, 1.0}) {
    push(scales, glm::dvec3(0));
    push(scales, glm::dvec3(0.42 * s));
    push(scales, glm::dvec3(0));
  }
  out.animate(core, "scale", "CUBICSPLINE", std::array{0.0, period_s / 2, period_s}, scales, 3);
}

void add_players(GlbWriter& out, const AnimatedParts& parts) {
  const int checker = out.texture("checker", checker_png(32, 4, {0.1, 0.3, 0.45}, {0.9, 0.86, 0.75}));
  const int crate =
      out.mesh("crate", out.primitive(box({0.9, 0.9, 0.9})), out.material("checker", pbr_textured(checker, 0, 0.5)));
  const int clock = out.node("stepping crate", {{"mesh", crate}, {"translation", vector_json({-2.1, 0.45, 1.9})}});
  animate_turn(out, clock, 8, 1, "STEP");

  const int bouncing = out.mesh("bouncing ball", parts.ball, out.material("ball", pbr_textured(checker, 0, 0.25)));
  const int ball = out.node("bouncing ball", {{"mesh", bouncing}, {"scale", vector_json(glm::dvec3(0.4))}});
  // A bounce is a parabola y = v t (1 - t/T), which a cubic spline with tangents of +-v meets exactly.
  constexpr double launch_m_per_s = 5.2, bounce_s = 1, rest_y = 0.4;
  std::vector<double> times, path;
  for (int i = 0; i <= 4; ++i) {
    times.push_back(i * bounce_s);
    push(path, glm::dvec3(0, -launch_m_per_s, 0));
    push(path, glm::dvec3(2.2, rest_y, 1.7));
    push(path, glm::dvec3(0, launch_m_per_s, 0));
  }
  out.animate(ball, "translation", "CUBICSPLINE", times, path, 3);

  const int gold = out.mesh("gold bead", parts.ball, out.material("gold", pbr({1, 0.76, 0.33, 1}, 1, 0.42)));
  const int orbit = out.node("orbit", {{"translation", vector_json({0, 1.2, 0})}});
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * pi * i / 5;
    out.child(
        orbit, "bead",
        {{"mesh", gold},
         {"scale", vector_json(glm::dvec3(0.22))},
         {"translation", vector_json({1.75 * std::cos(angle), 0.25 * std::sin(2 * angle), 1.75 * std::sin(angle)})}});
  }
  animate_turn(out, orbit, 8, -1, "LINEAR");
}

void add_camera(GlbWriter& out) {
  const glm::dvec3 eye{0, 2.5, 8.4}, target{0, 1.35, 0};
  const int rig = out.node("camera rig", json::object());
  const int camera = out.camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.72}, {"znear", 0.1}}}});
  const glm::dquat aim = glm::quat_cast(glm::dmat3(look_at_pose(eye, target)));
  const int node = out.child(
      rig, "camera", {{"camera", camera}, {"translation", vector_json(eye)}, {"rotation", quaternion_json(aim)}});
  std::vector<double> swing;
  for (double angle : {-0.35, 0.0, 0.35, 0.0, -0.35}) push(swing, rotation_about({0, 1, 0}, angle));
  out.animate(rig, "rotation", "LINEAR", std::array{0.0, 1.0, 2.0, 3.0, 4.0}, swing, 4);
  std::vector<double> path;
  for (double closer : {0.0, 1.2, 0.0}) {
    push(path, glm::dvec3(0));
    push(path, eye - closer * glm::normalize(eye - target));
    push(path, glm::dvec3(0));
  }
  out.animate(node, "translation", "CUBICSPLINE", std::array{0.0, period_s / 2, period_s}, path, 3);
}

}  // namespace

void make_animated(GlbWriter& out, SceneOptions& options) {
  const AnimatedParts parts{out.primitive(sphere(1, 20, 14, {2, 1})), out.primitive(column(0.32, 3.4, 12))};
  add_floor_and_sky(out, options, parts);
  add_columns(out, parts);
  add_centrepiece(out, parts);
  add_players(out, parts);
  add_lanterns(out, options, parts);
  add_sun(out, {-3, 1.4, 2}, {1, 0.62, 0.38}, 1.1);
  add_sun(out, {2, 4, 3}, {0.4, 0.5, 0.9}, 0.7);
  add_camera(out);
}

}  // namespace candela
