#include <array>
#include <cmath>
#include <numbers>

#include "testscenes/table.h"

namespace candela {
namespace {

struct Orbit {
  glm::dvec3 middle;
  double across_m, up_m, turns, phase;  // turns in the film
};

// Six balls on closed ways, which meet and part.
constexpr std::array<Orbit, 6> orbits = {{{{0, 0.9, 0}, 0.05, 0.03, 1, 0},
                                          {{0, 1.0, 0}, 0.55, 0.12, 1, 0.1},
                                          {{0.1, 0.85, 0}, 0.5, 0.2, -1, 0.4},
                                          {{-0.1, 0.8, 0.1}, 0.6, 0.15, 1, 0.6},
                                          {{0, 1.15, -0.05}, 0.35, 0.25, -2, 0.25},
                                          {{0, 0.6, 0.05}, 0.4, 0.1, 2, 0.8}}};

glm::dvec3 place(const Orbit& o, double fraction) {
  const double angle = 2 * std::numbers::pi * (o.turns * fraction + o.phase);
  return o.middle + glm::dvec3(o.across_m * std::cos(angle), o.up_m * std::sin(angle + o.phase),
                               0.7 * o.across_m * std::sin(angle));
}

void make_body(GlbWriter& out, int material) {
  constexpr double length_s = 4;
  constexpr int keys = 33;
  const int body = out.node("metaballs", json::object());
  json balls = json::array();
  for (size_t b = 0; b < orbits.size(); ++b) {
    std::vector<double> times, places;
    for (int k = 0; k < keys; ++k) {
      const double fraction = double(k) / (keys - 1);
      times.push_back(length_s * fraction);
      push(places, place(orbits[b], fraction));
    }
    const int node = out.child(body, fmt::format("ball {}", b), {{"translation", vector_json(place(orbits[b], 0))}});
    out.animate(node, "translation", "LINEAR", times, places, 3);
    balls.push_back({{"node", node}, {"radius", number(b == 0 ? 0.75 : 0.6)}});
  }
  out.use_extension("CANDELA_metaballs");
  out.root["nodes"][size_t(body)]["extensions"]["CANDELA_metaballs"] = {
      {"threshold", 0.3},
      {"cell", 0.05},
      {"material", material},
      {"balls", std::move(balls)},
      {"noise", {{"amplitude", 0.15}, {"frequency", 4}}}};
}

void make_stage(GlbWriter& out) {
  const int tiles = out.texture("tiles", checker_png(128, 8, {0.25, 0.27, 0.3}, {0.6, 0.58, 0.55}));
  out.node("floor", {{"mesh", out.mesh("floor", out.primitive(ground(8, 1, 2)),
                                       out.material("floor", pbr_textured(tiles, 0, 0.6)))}});
  const int post =
      out.mesh("post", out.primitive(box({0.25, 1.4, 0.25})), out.material("post", pbr({0.7, 0.3, 0.15, 1}, 0, 0.5)));
  out.node("post", {{"mesh", post}, {"translation", vector_json({-1.3, 0.7, -0.6})}});
  add_sun(out, {0.5, 1, 0.6}, {1, 0.95, 0.88}, 3);
  add_point_light(out, {-0.9, 1.6, 1.1}, {0.5, 0.7, 1}, 6);
  out.camera_node({0, 1.25, 3.2}, {0, 0.8, 0}, 0.7);
}

}  // namespace

void make_metaballs(GlbWriter& out, SceneOptions&) {
  make_stage(out);
  make_body(out, out.material("body", pbr({0.15, 0.55, 0.35, 1}, 0, 0.25)));
}

void make_metaballs_glass(GlbWriter& out, SceneOptions&) {
  make_stage(out);
  json glass = pbr({1, 1, 1, 1}, 0, 0.05);
  const auto extend = [&](const std::string& extension, json object) {
    out.use_extension(extension);
    glass["extensions"][extension] = std::move(object);
  };
  extend("KHR_materials_transmission", {{"transmissionFactor", 1}});
  extend("KHR_materials_ior", {{"ior", 1.33}});
  extend("KHR_materials_volume",
         {{"thicknessFactor", 0.5}, {"attenuationColor", vector_json({0.4, 0.8, 0.6})}, {"attenuationDistance", 0.6}});
  make_body(out, out.material("glass", glass));
}

}  // namespace candela
