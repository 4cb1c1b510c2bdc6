#include <cmath>

#include "testscenes/table.h"

namespace candela {
namespace {

constexpr double yfov_rad = 0.8, aspect = 16.0 / 9;
constexpr double first_m = 6, growth = 1.2;  // of the distance, layer by layer
constexpr int panels_x = 8, panels_y = 5, balls_x = 16, balls_y = 9;

struct Instances {
  std::vector<double> translation, scale;
  void add(glm::dvec3 at, glm::dvec3 size) {
    push(translation, at);
    push(scale, size);
  }
  void write(GlbWriter& out, std::string_view name, int mesh) const {
    const json attributes = {{"TRANSLATION", out.float_accessor(translation, 3)},
                             {"SCALE", out.float_accessor(scale, 3)}};
    out.node(name, {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  }
};

// Layers that each cover the view: a wall of panels, an eighth of which are missing, and finely cut balls before it.
// A layer is as large in the picture as any other, so that as many instances of each size are hidden as there are
// layers behind.
void make_layers(GlbWriter& out, SceneOptions& options, int layers) {
  out.use_extension("EXT_mesh_gpu_instancing");
  const int panel =
      out.mesh("panel", out.primitive(quad(1, 1)), out.material("panel", pbr({0.6, 0.58, 0.5, 1}, 0, 0.8)));
  const int ball =
      out.mesh("ball", out.primitive(sphere(0.5, 24, 16)), out.material("ball", pbr({0.2, 0.45, 0.7, 1}, 0, 0.4)));
  Instances panels, balls;
  for (int layer = 0; layer < layers; ++layer) {
    const double distance = first_m * std::pow(growth, layer);
    const double height = 2.1 * distance * std::tan(yfov_rad / 2), width = height * aspect;
    const auto at = [&](double u, double v, double depth) {
      return glm::dvec3((u - 0.5) * width, (v - 0.5) * height, -depth);
    };
    for (int y = 0; y < panels_y; ++y)
      for (int x = 0; x < panels_x; ++x) {
        if (options.rng.next() % 8 == 0) continue;
        // A little over each other, so that no sample falls between them.
        panels.add(at((x + 0.5) / panels_x, (y + 0.5) / panels_y, distance),
                   {1.02 * width / panels_x, 1.02 * height / panels_y, 1});
      }
    for (int y = 0; y < balls_y; ++y)
      for (int x = 0; x < balls_x; ++x)
        balls.add(at((x + 0.5) / balls_x, (y + 0.5) / balls_y, 0.95 * distance),
                  glm::dvec3(options.rng.uniform(0.3, 0.6) * height / balls_y));
  }
  panels.write(out, "panels", panel);
  balls.write(out, "balls", ball);
  add_sun(out, {1, 2, 3}, {1, 0.95, 0.9}, 3);
  for (int i = 0; i < 4; ++i) add_point_light(out, {2.0 * i - 3, 1, -4}, {1, 0.8, 0.6}, 8);
  out.camera_node({0, 0, 0}, {0, 0, -1}, yfov_rad);
}

}  // namespace

void make_depth_complexity_1(GlbWriter& out, SceneOptions& options) { make_layers(out, options, 1); }
void make_depth_complexity_4(GlbWriter& out, SceneOptions& options) { make_layers(out, options, 4); }
void make_depth_complexity_16(GlbWriter& out, SceneOptions& options) { make_layers(out, options, 16); }

}  // namespace candela
