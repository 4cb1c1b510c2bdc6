#include <array>
#include <cmath>
#include <numbers>

#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {
namespace {

json see_through(json material) {
  material["alphaMode"] = "BLEND";
  material["doubleSided"] = true;
  return material;
}
void add_checkered_wall(GlbWriter& out, double z) {
  const int checker = out.texture("checker", checker_png(32, 8, {0.1, 0.1, 0.12}, {0.7, 0.7, 0.65}));
  const int wall = out.mesh("wall", out.primitive(quad(8, 6)), out.material("wall", pbr_textured(checker, 0, 0.9)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 0, z})}});
}

}  // namespace

void make_sheets(GlbWriter& out, SceneOptions&) {
  add_checkered_wall(out, -3);
  const json square = out.primitive(quad(2, 2));
  constexpr int count = 8;
  for (int i = 0; i < count; ++i) {
    const double hue = 2 * std::numbers::pi * i / count;
    const glm::dvec3 color = 0.5 + 0.45 * glm::dvec3(std::cos(hue), std::cos(hue - 2.1), std::cos(hue + 2.1));
    const int sheet =
        out.mesh("sheet", square, out.material("sheet", see_through(pbr({color, 0.2 + 0.08 * i}, 0, 0.6))));
    out.node("sheet",
             {{"mesh", sheet}, {"translation", vector_json({-0.7 + 0.2 * i, 0.35 - 0.1 * i, -1.6 + 0.3 * i})}});
  }
  add_sun(out, {0.5, 1, 2}, {1, 1, 1}, 3);
  out.camera_node({0, 0, 5}, {0, 0, 0}, 0.7);
}

// Squares through one another: no order of whole sheets is right.
void make_crossing(GlbWriter& out, SceneOptions&) {
  add_checkered_wall(out, -2);
  const json square = out.primitive(quad(2, 2));
  const std::array<glm::dvec3, 3> colors{{{1, 0.15, 0.1}, {0.1, 0.9, 0.2}, {0.15, 0.3, 1}}};
  const std::array<glm::dvec3, 3> axes{{{0, 1, 0}, {0, 1, 0}, {1, 0, 0}}};
  const std::array angles{0.7, -0.7, 1.0};
  for (size_t i = 0; i < colors.size(); ++i) {
    const int sheet = out.mesh("sheet", square, out.material("sheet", see_through(pbr({colors[i], 0.5}, 0, 0.6))));
    out.node("sheet", {{"mesh", sheet}, {"rotation", quaternion_json(rotation_about(axes[i], angles[i]))}});
  }
  add_sun(out, {0.5, 1, 2}, {1, 1, 1}, 3);
  out.camera_node({0.4, 0.5, 4}, {0, 0, 0}, 0.7);
}

// A crown of about a thousand leaves with soft edges.
void make_foliage(GlbWriter& out, SceneOptions& options) {
  add_checkered_wall(out, -3);
  const int leaf =
      out.texture("leaf", png_from(64, 64, 4, [](double u, double v) {
                    const double x = 2 * u - 1, y = 2 * v - 1;
                    const double edge = 0.45 * (1 - y * y) - std::abs(x);
                    const double rib = std::exp(-200 * x * x);
                    return glm::dvec4(0.5 + 0.3 * rib, 0.8 + 0.15 * rib, 0.35, std::clamp(0.5 + 8 * edge, 0.0, 1.0));
                  }));
  const json card = out.primitive(quad(0.35, 0.35));
  std::array<int, 4> meshes{};
  for (size_t i = 0; i < meshes.size(); ++i) {
    json material = see_through(pbr_textured(leaf, 0, 0.7));
    material["pbrMetallicRoughness"]["baseColorFactor"] = {0.6 + 0.13 * double(i), 1 - 0.12 * double(i), 0.5, 0.9};
    meshes[i] = out.mesh("leaf", card, out.material("leaf", material));
  }
  Rng& rng = options.rng;
  for (int i = 0; i < 1000; ++i) {
    const double height = 2 * rng.uniform() - 1, turn = 2 * std::numbers::pi * rng.uniform();
    const double flat = std::sqrt(1 - height * height), radius = 1.3 * std::cbrt(rng.uniform());
    const glm::dvec3 at = radius * glm::dvec3(flat * std::cos(turn), height, flat * std::sin(turn));
    const glm::dvec3 axis(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5 + 1e-3);
    out.node("leaf", {{"mesh", meshes[size_t(i) % meshes.size()]},
                      {"translation", vector_json(at)},
                      {"rotation", quaternion_json(rotation_about(glm::normalize(axis), 6 * rng.uniform()))}});
  }
  add_sun(out, {1, 2, 2}, {1, 0.95, 0.85}, 3);
  out.camera_node({0, 0.2, 5}, {0, 0, 0}, 0.6);
}

// Puffs that face the camera, thin and dark to bright, about a lamp of their own.
void make_smoke(GlbWriter& out, SceneOptions& options) {
  add_checkered_wall(out, -3);
  const int puff = out.texture("puff", png_from(64, 64, 4, [](double u, double v) {
                                 const double r = std::hypot(2 * u - 1, 2 * v - 1);
                                 const double soft = std::clamp(1 - r, 0.0, 1.0);
                                 return glm::dvec4(1, 1, 1, soft * soft * (3 - 2 * soft));
                               }));
  const json card = out.primitive(quad(1, 1));
  std::array<int, 5> meshes{};
  for (size_t i = 0; i < meshes.size(); ++i) {
    const double grey = 0.15 + 0.17 * double(i);
    json material = see_through(pbr_textured(puff, 0, 1));
    material["pbrMetallicRoughness"]["baseColorFactor"] = {grey, grey * 0.95, grey * 0.9, 0.35};
    meshes[i] = out.mesh("puff", card, out.material("puff", material));
  }
  Rng& rng = options.rng;
  for (int i = 0; i < 150; ++i) {
    const double up = rng.uniform(), turn = 2 * std::numbers::pi * rng.uniform();
    const double wide = (0.15 + 0.8 * up) * std::sqrt(rng.uniform());
    const glm::dvec3 at(wide * std::cos(turn), 3 * up - 1.6, wide * std::sin(turn));
    const double size = 0.5 + 0.9 * up;
    out.node("puff", {{"mesh", meshes[size_t(5 * rng.uniform())]},
                      {"translation", vector_json(at)},
                      {"scale", vector_json(glm::dvec3(size))}});
  }
  add_sun(out, {1, 2, 2}, {1, 0.95, 0.9}, 2);
  add_point_light(out, {0, -1.4, 0.6}, {1, 0.5, 0.2}, 3);
  out.camera_node({0, 0, 5}, {0, 0, 0}, 0.7);
}

}  // namespace candela
