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

// A head, and strands that hang down from its crown in one mesh: ribbons that grow thinner and clearer, in the order in
// which they are sown.
void make_hair(GlbWriter& out, SceneOptions& options) {
  add_checkered_wall(out, -3);
  const int head =
      out.mesh("head", out.primitive(sphere(0.8, 32, 16)), out.material("skin", pbr({0.8, 0.6, 0.5, 1}, 0, 0.6)));
  out.node("head", {{"mesh", head}});
  const int strand = out.texture("strand", png_from(16, 32, 4, [](double u, double v) {
                                   const double x = 2 * u - 1;
                                   return glm::dvec4(0.9, 0.8, 0.6, (1 - x * x) * (0.85 - 0.5 * v));
                                 }));
  constexpr int strands = 1000, parts = 12;
  constexpr double length_m = 1.9;
  Rng& rng = options.rng;
  Shape hair;
  for (int s = 0; s < strands; ++s) {
    const double turn = 2 * std::numbers::pi * rng.uniform(), from = 0.5 * std::sqrt(rng.uniform());
    const double off = 0.02 + 0.1 * rng.uniform(), wave = 2 * std::numbers::pi * rng.uniform();
    const auto first = uint32_t(hair.position.size());
    for (int i = 0; i <= parts; ++i) {
      const double t = double(i) / parts, along = from + length_m * t;
      // Over the head by its angle, then straight down.
      const double angle = std::min(along / 0.8, std::numbers::pi / 2),
                   down = std::max(along - 0.4 * std::numbers::pi, 0.0);
      const double radius = (0.8 + off) * std::sin(angle), height = (0.8 + off) * std::cos(angle) - down;
      const double at = turn + 0.1 * std::sin(wave + 5 * t);
      const glm::dvec3 out_of(std::sin(at), 0, std::cos(at)), across(std::cos(at), 0, -std::sin(at));
      for (const double side : {-1.0, 1.0}) {
        hair.position.push_back(out_of * radius + glm::dvec3(0, height, 0) + across * (side * 0.012));
        hair.normal.push_back(glm::normalize(out_of * std::sin(angle) + glm::dvec3(0, std::cos(angle), 0)));
        hair.uv.push_back({0.5 + 0.5 * side, t});
      }
      if (i == parts) continue;
      const uint32_t a = first + 2 * uint32_t(i);
      for (const uint32_t corner : {a, a + 3, a + 1, a, a + 2, a + 3}) hair.index.push_back(corner);
    }
  }
  const int mesh =
      out.mesh("hair", out.primitive(hair), out.material("hair", see_through(pbr_textured(strand, 0, 0.5))));
  out.node("hair", {{"mesh", mesh}});
  add_sun(out, {1, 2, 2}, {1, 0.95, 0.85}, 3);
  out.camera_node({0, -0.2, 4.5}, {0, -0.3, 0}, 0.7);
}

// Rows of houses that are seen through from front to back, as buildings are exported: all panes of a house in one mesh.
void make_windows(GlbWriter& out, SceneOptions& options) {
  add_checkered_wall(out, -9);
  Shape panes;
  const Shape pane = quad(0.8, 1);
  for (const double z : {0.9, -0.9})  // the front ones are drawn first
    for (int i = 0; i < 12; ++i) {
      const glm::dvec3 at(-1.5 + (i % 4), -1.1 + 1.1 * (i / 4), z);
      const auto first = uint32_t(panes.position.size());
      for (const glm::dvec3 p : pane.position) panes.position.push_back(p + at);
      panes.normal.insert(panes.normal.end(), pane.normal.begin(), pane.normal.end());
      panes.uv.insert(panes.uv.end(), pane.uv.begin(), pane.uv.end());
      for (const uint32_t corner : pane.index) panes.index.push_back(first + corner);
    }
  const int frame = out.material("frame", pbr({0.5, 0.35, 0.25, 1}, 0, 0.8));
  const json beam = out.primitive(quad(0.2, 3.6));
  const json glass = out.primitive(panes);
  Rng& rng = options.rng;
  for (int house = 0; house < 4; ++house) {
    const glm::dvec3 color = 0.05 + 0.7 * glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform());
    const int mesh = out.mesh("panes", glass, out.material("pane", see_through(pbr({color, 0.45}, 0, 0.3))));
    const glm::dvec3 at(0.7 * (house % 2) - 0.35, 0.2 * house - 0.3, -2.2 * house);
    const int node = out.node("house", {{"translation", vector_json(at)}});
    out.child(node, "panes", {{"mesh", mesh}});
    for (int i = 0; i < 5; ++i)
      for (const double z : {0.9, -0.9})
        out.child(node, "beam",
                  {{"mesh", out.mesh("beam", beam, frame)}, {"translation", vector_json({-2.0 + i, 0, z})}});
  }
  add_sun(out, {1, 1, 3}, {1, 0.95, 0.85}, 3);
  out.camera_node({1.4, 0.6, 6}, {0, 0.1, -2}, 0.7);
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
