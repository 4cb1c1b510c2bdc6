#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demoscenes/city.h"
#include "math/transforms.h"
#include "testscenes/table.h"

// The visitors: a body of six balls that wanders over the square and looks at things, and the saucer that takes it
// along, in a cone of light.
namespace candela::city {
namespace {

using std::numbers::pi;
constexpr glm::dvec3 hover{21.5, 11.3, -18.5};

double ease(double from, double to, double t) {
  const double u = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return u * u * u * (u * (6 * u - 15) + 10);
}

}  // namespace

glm::dvec3 saucer_at(double t) {
  const double u = ease(appear_s - 1.2, arrive_s, t);
  glm::dvec3 at = glm::mix(glm::dvec3(62, 74, -180), hover, u);
  at.y += 9 * std::sin(pi * u) * u;  // it comes down last
  at += glm::dvec3(0.25 * std::sin(1.9 * t), 0.22 * std::sin(2.6 * t), 0.2 * std::cos(1.6 * t)) * ease(13, 15, t);
  const double away = std::max(t - leave_s, 0.0);
  return at + glm::dvec3(26, 16, -30) * away * away * away * 0.75 + glm::dvec3(0, 3, 0) * away * away;
}

namespace {

struct Stop {
  double time_s;
  glm::dvec3 at;
};

// From stop to stop, gently off and gently there.
glm::dvec3 between(std::span<const Stop> stops, double t) {
  for (size_t i = 1; i < stops.size(); ++i)
    if (t < stops[i].time_s)
      return glm::mix(stops[i - 1].at, stops[i].at, ease(stops[i - 1].time_s, stops[i].time_s, t));
  return stops.back().at;
}

// --- the body

constexpr std::array<Stop, 9> blob_stops{{{0, {34, 0, -14}},
                                          {3, {27, 0, -13}},
                                          {5.8, {24, 0, -13}},
                                          {9.0, {7.9, 0, -7.9}},
                                          {10.8, {7.5, 0, -7.5}},
                                          {13.2, {16.5, 0, -15}},
                                          {14.6, {21, 0, -18.2}},
                                          {15.4, {21.5, 0, -18.5}},
                                          {20, {21.5, 0, -18.5}}}};

glm::dvec3 blob_at(double t) {
  glm::dvec3 at = between(blob_stops, t);
  at.y = kerb_m - 0.1;
  // It hops a little as it goes.
  const glm::dvec3 move = between(blob_stops, t + 0.05) - between(blob_stops, t - 0.05);
  at.y += 0.22 * std::abs(std::sin(4.2 * t)) * std::min(glm::length(glm::dvec2(move.x, move.z)) / 0.25, 1.0);
  const double lifted = ease(lift_from_s, lift_to_s, t);
  return glm::mix(at, saucer_at(t) - glm::dvec3(0, 0.8, 0), lifted);
}

// Where it looks: the way it goes, then at the cars, up the lamps, and up to the saucer.
glm::dvec3 blob_look(double t) {
  static constexpr std::array<Stop, 11> looks{{{0, {-1, 0.1, 0.2}},
                                               {4.0, {-0.2, 0.9, 0.5}},
                                               {6.0, {-1, 0.2, 0.1}},
                                               {8.7, {0, 0.35, 1}},
                                               {9.6, {0.1, 0.3, 1}},
                                               {10.2, {-0.9, 0.2, 0.6}},
                                               {10.8, {0.4, 0.7, 0.7}},
                                               {12.0, {0.8, 0.2, -0.6}},
                                               {12.9, {-0.75, 0.3, 0.65}},
                                               {13.8, {-0.75, 0.3, 0.65}},
                                               {14.9, {-0.4, 0.9, 0.35}}}};
  return glm::normalize(between(looks, t));
}

// Eyes look a little less up and down than the head reaches, and now and then aside.
glm::dvec3 gaze(double t) {
  const glm::dvec3 look = blob_look(t);
  const double aside = 0.35 * std::sin(1.1 * t) * std::sin(2.3 * t), c = std::cos(aside), s = std::sin(aside);
  return glm::normalize(glm::dvec3(c * look.x + s * look.z, std::clamp(look.y, -0.5, 0.9), c * look.z - s * look.x));
}

glm::dvec3 ball_at(size_t ball, double t) {
  const double stretch = ease(lift_from_s - 0.3, lift_from_s + 0.7, t) * (1 - ease(lift_to_s - 0.5, lift_to_s, t));
  const glm::dvec3 look = blob_look(t);
  glm::dvec3 at(0, 0.72, 0);
  if (ball == 1) at = glm::dvec3(0, 0.9, 0) + look * (0.8 + 0.12 * std::sin(3.1 * t));  // its head
  if (ball >= 2) {
    const double turn = (ball % 2 ? 1.3 : -1.1) * t + 2 * pi * double(ball) / 4;
    at = glm::dvec3(0.5 * std::cos(turn), 0.5 + 0.12 * std::sin(1.7 * t + double(ball)), 0.5 * std::sin(turn));
  }
  at.y += stretch * (ball == 1 ? 0.4 : ball == 0 ? 0.15 : -0.1 * double(ball - 1));
  at.x *= 1 - 0.35 * stretch, at.z *= 1 - 0.35 * stretch;
  return at;
}

// Two eyes that look to -Z, about the middle of the ball that is its head.
int make_eyes(Town& town) {
  MeshKit kit;
  const auto ball = [&](const Paint& paint, glm::dvec3 at, double radius) {
    std::vector<OutlinePoint> outline;
    for (int i = 0; i <= 10; ++i) {
      const double a = pi * (double(i) / 10 - 0.5);
      outline.push_back({radius * std::cos(a), radius * std::sin(a), std::cos(a), std::sin(a)});
    }
    kit.turned(paint, at, outline, 16);
  };
  for (double side : {-1.0, 1.0}) {
    ball(town.m.line_paint.tinted(glm::dvec3(0.85)), {0.2 * side, 0.1, -0.42}, 0.15);
    ball(town.m.glass.tinted(glm::dvec3(0.01)), {0.19 * side, 0.11, -0.49}, 0.092);
  }
  return kit.write(town.out, "eyes");
}

void add_blob(Town& town) {
  GlbWriter& out = town.out;
  std::vector<double> times;
  for (int k = 0; k <= int(end_s * frames_per_s); ++k) times.push_back(k / frames_per_s);
  const int body = out.node("blob", {{"translation", vector_json(blob_at(0))}});
  std::vector<glm::dvec3> places;
  for (double t : times) places.push_back(blob_at(t));
  animate_places(out, body, times, places);
  const int sizes = [&] {
    std::vector<double> values;
    for (double t : times) push(values, glm::dvec3(1 - 0.72 * ease(lift_to_s - 0.9, lift_to_s, t)));
    return add_sampler(out, times, values, 3);
  }();
  play(out, sizes, body, "scale");
  json balls = json::array();
  constexpr std::array<double, 6> radius{1.5, 0.95, 1.2, 1.1, 1.2, 1.0};
  for (size_t b = 0; b < radius.size(); ++b) {
    const int ball = out.child(body, fmt::format("ball {}", b), {{"translation", vector_json(ball_at(b, 0))}});
    std::vector<glm::dvec3> at;
    for (double t : times) at.push_back(ball_at(b, t));
    animate_places(out, ball, times, at);
    if (b == 1) {
      const int eyes = out.child(ball, "eyes", {{"mesh", make_eyes(town)}});
      std::vector<glm::dquat> turns;
      for (double t : times) turns.push_back(glm::quat_cast(glm::dmat3(look_at_pose({0, 0, 0}, gaze(t)))));
      animate_turns(out, eyes, times, turns);
    }
    balls.push_back({{"node", ball}, {"radius", number(radius[b])}});
  }
  // It glows by itself, the more the more curious it is, and less in the beam, whose light would not show its shape.
  json skin = pbr({0.15, 0.62, 0.43, 1}, 0, 0.2);
  skin["emissiveFactor"] = vector_json({0.006, 0.1, 0.066});
  const int material = out.material("blob", skin);
  const int light =
      out.light({{"name", "blob"}, {"type", "point"}, {"color", vector_json({0.1, 1, 0.6})}, {"range", 9}});
  std::vector<double> glow, candela;
  std::vector<double> glow_times;
  for (int k = 0; k <= int(end_s * 12); ++k) {
    const double t = k / 12.0, pulse = 0.75 + 0.25 * std::sin(4.6 * t) * std::sin(1.3 * t);
    const double curious = 0.5 + 0.5 * ease(7.5, 9, t) * (1 - 0.6 * ease(10.4, 11.4, t)) + 0.5 * ease(14.8, 16, t);
    const double dark = ease(4.5, 7.2, t);
    glow_times.push_back(t);
    const double in_beam = ease(beam_from_s - 0.4, beam_full_s, t);
    push(glow, glm::dvec3(0.006, 0.1, 0.066) * (0.12 + 0.88 * dark) * pulse * curious * (1 - 0.85 * in_beam));
    candela.push_back(26 * dark * pulse * curious * (1 - ease(lift_to_s - 0.8, lift_to_s, t)));
  }
  out.animate_pointer(fmt::format("/materials/{}/emissiveFactor", material), "LINEAR", glow_times, glow, 3);
  out.animate_pointer(fmt::format("/extensions/KHR_lights_punctual/lights/{}/intensity", light), "LINEAR", glow_times,
                      candela, 1);
  LightArrays inside;
  inside.add({0, 0.8, 0}, {1, 1, 1}, 1, 9, {0, 1, 0});
  out.child(body, "blob light", {{"extensions", inside.extension(out, light)}});
  out.use_extension("CANDELA_metaballs");
  out.root["nodes"][size_t(body)]["extensions"]["CANDELA_metaballs"] = {
      {"threshold", 0.35},
      {"cell", 0.09},
      {"material", material},
      {"balls", std::move(balls)},
      {"noise", {{"amplitude", 0.06}, {"frequency", 3}}}};
}

// --- the saucer

int make_saucer(Town& town, int glow) {
  MeshKit kit;
  const Paint hull = town.m.chrome.tinted(glm::dvec3(0.75, 0.78, 0.82)), dark = town.m.metal.tinted(glm::dvec3(0.2));
  const std::array<OutlinePoint, 12> lower{{{0.0, -0.95, 0, -1},
                                            {1.5, -0.95, 0, -1},
                                            {1.5, -0.95, 0.5, -0.86},
                                            {1.75, -0.8, 0.5, -0.86},
                                            {1.75, -0.8, 0.2, -0.98},
                                            {3.2, -0.48, 0.24, -0.97},
                                            {4.3, -0.16, 0.4, -0.92},
                                            {4.6, 0.0, 1, 0},
                                            {4.3, 0.16, 0.35, 0.94},
                                            {3.2, 0.5, 0.26, 0.97},
                                            {2.2, 0.85, 0.36, 0.93},
                                            {1.7, 1.1, 0.5, 0.87}}};
  kit.turned(hull, {0, 0, 0}, lower, 48);
  std::vector<OutlinePoint> dome;
  for (int i = 0; i <= 8; ++i) {
    const double a = pi / 2 * i / 8;
    dome.push_back({1.75 * std::cos(a), 1.05 + 1.15 * std::sin(a), std::cos(a), std::sin(a)});
  }
  kit.turned(town.m.glass.tinted({0.04, 0.09, 0.1}), {0, 0, 0}, dome, 32);
  for (int i = 0; i < 12; ++i) {  // ribs over the hull
    const double a = 2 * pi * i / 12;
    const glm::dvec3 way(std::cos(a), 0, std::sin(a));
    kit.tube(dark, 1.75 * way + glm::dvec3(0, 1.08, 0), 0.05, 4.25 * way + glm::dvec3(0, 0.19, 0), 0.03, 5);
    kit.tube(dark, 1.75 * way + glm::dvec3(0, -0.8, 0), 0.05, 4.25 * way + glm::dvec3(0, -0.19, 0), 0.03, 5);
  }
  Materials m = town.m;
  m.glows = glow;
  // Lamps around the rim, and the ring that the beam comes out of.
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * pi * (i + 0.5) / 24;
    const glm::dvec3 way(std::cos(a), 0, std::sin(a)), across(-way.z, 0, way.x),
        at = 3.75 * way + glm::dvec3(0, 0.36, 0);
    const dusk::Glow color = i % 3 == 0 ? dusk::amber_glow : i % 3 == 1 ? dusk::cool_glow : dusk::green_glow;
    for (double y : {1.0, -1.0}) {
      const glm::dvec3 up(-0.09 * way.x * y, 0.03, -0.09 * way.z * y), corner = glm::dvec3(at.x, y * at.y, at.z);
      glow_quad(kit, m, corner + 0.13 * across * y - 1.3 * up * y, -0.26 * across * y, 2.6 * up * y, color);
    }
  }
  glow_band(kit, m, {0, -0.97, 0}, {0.9, 0}, {1.4, 0.0}, 32, dusk::cool_glow);
  return kit.write(town.out, "saucer");
}

void add_saucer(Town& town) {
  GlbWriter& out = town.out;
  std::vector<double> times{0};
  for (int k = int(appear_s * frames_per_s); k <= int(end_s * frames_per_s); ++k) times.push_back(k / frames_per_s);
  std::vector<glm::dvec3> places;
  std::vector<glm::dquat> turns;
  for (double t : times) {
    // Until it comes it lies below the ground.
    places.push_back(t < appear_s ? glm::dvec3(0, -20, -32) : saucer_at(t));
    // It leans into where it is going.
    const glm::dvec3 speed = (saucer_at(t + 0.1) - 2.0 * saucer_at(t) + saucer_at(t - 0.1)) / 0.01;
    const glm::dvec2 lean = glm::clamp(glm::dvec2(speed.z, -speed.x) * 0.012, -0.4, 0.4);
    turns.push_back(rotation_about({1, 0, 0}, t < appear_s ? 0 : lean.x) *
                    rotation_about({0, 0, 1}, t < appear_s ? 0 : lean.y));
  }
  const int saucer = out.node("saucer", {{"translation", vector_json(places[0])}});
  animate_places(out, saucer, times, places);
  animate_turns(out, saucer, times, turns);
  const int hull =
      out.child(saucer, "hull", {{"mesh", make_saucer(town, town.switches.material(town.m.glows, appear_s - 1))}});
  std::vector<double> spin_times;
  std::vector<glm::dquat> spin;
  for (double t = 0; t <= end_s; t += 0.5) {
    spin_times.push_back(t);
    spin.push_back(rotation_about({0, 1, 0}, 0.9 * t));
  }
  animate_turns(out, hull, spin_times, spin);
  LightArrays rim;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * pi * (i + 0.5) / 24;
    const glm::dvec3 color = i % 3 == 0   ? glm::dvec3(1, 0.55, 0.15)
                             : i % 3 == 1 ? glm::dvec3(0.6, 0.85, 1)
                                          : glm::dvec3(0.15, 1, 0.5);
    rim.aim({0.5 * std::cos(a), -1, 0.5 * std::sin(a)});
    rim.add({4.9 * std::cos(a), -0.3, 4.9 * std::sin(a)}, color, 60, 22, {0.5, 1.2, i / 12.0});
  }
  out.child(hull, "rim lamps",
            {{"extensions", rim.extension(out, spot(town.switches, "rim lamp", 26, 0.4, 1.1, appear_s - 1))}});

  // What lights the hull itself.
  LightArrays under;
  for (int i = 0; i < 8; ++i) {
    const double a = 2 * pi * i / 8;
    under.add({2.6 * std::cos(a), -1.7, 2.6 * std::sin(a)}, {0.5, 0.85, 1}, 9, 5, {0, 1, 0});
    under.aim({0.4 * std::cos(a), 1, 0.4 * std::sin(a)});
  }
  out.child(hull, "hull lamps",
            {{"extensions", under.extension(out, spot(town.switches, "hull lamp", 5, 0.5, 1.1, appear_s - 1))}});

  // What lights the body from the sides in the beam, warm and cold, so that it looks round.
  LightArrays inner;
  for (int i = 0; i < 6; ++i) {
    const double a = 2 * pi * i / 6;
    const glm::dvec3 color = i < 3 ? glm::dvec3(1, 0.62, 0.3) : glm::dvec3(0.35, 0.7, 1);
    inner.add({3 * std::cos(a), -0.95, 3 * std::sin(a)}, color, 220, 14, {0, 1, 0});
    inner.aim({-3 * std::cos(a), -3.6, -3 * std::sin(a)});
  }
  out.child(hull, "inner lamps",
            {{"extensions", inner.extension(out, spot(town.switches, "inner lamp", 14, 0.2, 0.5, beam_full_s))}});

  // The beam: a searchlight while it flies, then full.
  const int beam = out.light({{"name", "beam"},
                              {"type", "spot"},
                              {"color", vector_json({0.55, 0.95, 1})},
                              {"range", 46},
                              {"spot", {{"innerConeAngle", 0.13}, {"outerConeAngle", 0.2}}}});
  // Less as the body comes near, which would be white all over.
  const std::array on{0.0, 13.0, 13.3, beam_from_s, beam_full_s, lift_from_s, 17.0, beam_to_s, 18.45, beam_off_s};
  const std::array candela{0.0, 0.0, 4000.0, 4000.0, 4500.0, 4500.0, 2600.0, 2600.0, 800.0, 0.0};
  out.animate_pointer(fmt::format("/extensions/KHR_lights_punctual/lights/{}/intensity", beam), "LINEAR", on, candela,
                      1);
  LightArrays one;
  one.add({0, -1.05, 0}, {1, 1, 1}, 1, 46, {0, 1, 0});
  one.aim({0, -1, 0});
  out.child(saucer, "beam", {{"extensions", one.extension(out, beam)}});
}

}  // namespace

void add_city_visitors(Town& town) {
  add_blob(town);
  add_saucer(town);
}

}  // namespace candela::city
