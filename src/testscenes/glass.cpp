#include "testscenes/table.h"

namespace candela {
namespace {

struct Glass {
  glm::dvec3 color{1};
  double roughness = 0, ior = 1.5, thickness_m = 0, dispersion = 0;
  glm::dvec3 attenuation{1};
  double distance_m = 0.5;
};

int glass(GlbWriter& out, std::string_view name, const Glass& g) {
  json material = pbr({g.color, 1}, 0, g.roughness);
  const auto extend = [&](const std::string& extension, json object) {
    out.use_extension(extension);
    material["extensions"][extension] = std::move(object);
  };
  extend("KHR_materials_transmission", {{"transmissionFactor", 1}});
  extend("KHR_materials_ior", {{"ior", number(g.ior)}});
  if (g.thickness_m > 0)
    extend("KHR_materials_volume", {{"thicknessFactor", number(g.thickness_m)},
                                    {"attenuationColor", vector_json(g.attenuation)},
                                    {"attenuationDistance", number(g.distance_m)}});
  if (g.dispersion > 0) extend("KHR_materials_dispersion", {{"dispersion", number(g.dispersion)}});
  return out.material(name, material);
}

// Gives light of its own and takes none, so that errors are those of the glass before it.
int paint(GlbWriter& out, std::string_view name, json material) {
  material["extensions"]["KHR_materials_unlit"] = json::object();
  return out.material(name, material);
}

}  // namespace

void make_glass(GlbWriter& out, SceneOptions&) {
  out.use_extension("KHR_materials_unlit");
  const int tiles = out.texture("tiles", checker_png(128, 16, {0.1, 0.16, 0.25}, {0.85, 0.8, 0.7}));
  const int wall = out.mesh("wall", out.primitive(quad(6, 3)), paint(out, "wall", pbr_textured(tiles, 0, 1)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 1.5, -1.2})}});
  const int wood = out.texture("boards", checker_png(64, 8, {0.3, 0.2, 0.13}, {0.42, 0.3, 0.2}));
  const int floor = out.mesh("floor", out.primitive(ground(6, 1, 2)), paint(out, "floor", pbr_textured(wood, 0, 1)));
  out.node("floor", {{"mesh", floor}, {"translation", vector_json({0, 0, 1.7})}});
  const json post = out.primitive(box({0.08, 1.1, 0.08}));
  const glm::dvec3 colors[] = {{0.9, 0.2, 0.12}, {0.15, 0.6, 0.25}, {0.95, 0.75, 0.1}, {0.2, 0.3, 0.9}};
  for (int i = 0; i < 4; ++i)  // from touching the frosted sheets to far behind them
    out.node("post", {{"mesh", out.mesh("post", post, paint(out, "post", pbr({colors[i], 1}, 0, 1)))},
                      {"translation", vector_json({-1.55 + 0.42 * i, 0.55, 0.1 - 0.35 * i})}});

  const json sheet = out.primitive(quad(0.8, 1.3));
  const auto put = [&](std::string_view name, const json& shape, int material, glm::dvec3 at) {
    out.node(name, {{"mesh", out.mesh(name, shape, material)}, {"translation", vector_json(at)}});
  };
  put("frosted", sheet, glass(out, "frosted", {.roughness = 0.2}), {-1.35, 0.7, 0.2});
  put("more frosted", sheet, glass(out, "more frosted", {.roughness = 0.45}), {-0.5, 0.7, 0.2});
  put("red sheet", out.primitive(quad(0.5, 0.5)), glass(out, "red sheet", {.color = {1, 0.25, 0.2}}),
      {0.25, 1.15, 0.4});
  put("slab", out.primitive(box({0.5, 0.7, 0.3})),
      glass(out, "slab", {.thickness_m = 0.3, .attenuation = {0.3, 0.75, 0.6}}), {0.35, 0.35, 0.3});
  put("ball", out.primitive(sphere(0.35, 48, 32)), glass(out, "ball", {.thickness_m = 0.55}), {1.05, 0.35, 0.35});
  put("prism", out.primitive(box({0.3, 0.8, 0.3})),
      glass(out, "prism", {.ior = 1.8, .thickness_m = 0.4, .dispersion = 6}), {1.6, 0.4, 0.1});
  const json smoke = out.primitive(quad(0.5, 0.35));
  json haze = pbr({0.9, 0.9, 0.95, 0.5}, 0, 1);
  haze["alphaMode"] = "BLEND";
  const int air = paint(out, "smoke", haze);
  put("smoke behind", smoke, air, {-0.5, 1.05, -0.2});
  put("smoke before", smoke, air, {-1.0, 0.3, 0.6});
  out.camera_node({0, 1.1, 4.2}, {0, 0.75, 0}, 0.5);
}

// Coloured sheets over each other on the left, frosted sheets and slabs on the right, and a ball and a lens of glass
// over one another in the middle.
void make_panes(GlbWriter& out, SceneOptions&) {
  out.use_extension("KHR_materials_unlit");
  const int tiles = out.texture("tiles", checker_png(128, 16, {0.1, 0.16, 0.25}, {0.85, 0.8, 0.7}));
  const int wall = out.mesh("wall", out.primitive(quad(8, 4)), paint(out, "wall", pbr_textured(tiles, 0, 1)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 0, -1.5})}});
  const auto put = [&](std::string_view name, const json& shape, const Glass& g, glm::dvec3 at) {
    out.node(name, {{"mesh", out.mesh(name, shape, glass(out, name, g))}, {"translation", vector_json(at)}});
  };
  const json sheet = out.primitive(quad(0.8, 0.8)), slab = out.primitive(box({0.7, 0.5, 0.1}));
  const glm::dvec3 colors[] = {{1, 0.3, 0.25}, {1, 0.85, 0.3}, {0.4, 0.9, 0.45}, {0.35, 0.7, 1}, {0.75, 0.45, 1}};
  for (int i = 0; i < 5; ++i)
    put("sheet", sheet, {.color = colors[i]}, {-1.75 + 0.17 * i, 0.3 - 0.15 * i, -0.8 + 0.25 * i});
  for (int i = 0; i < 3; ++i)
    put("frosted", sheet, {.color = colors[4 - i], .roughness = 0.15 + 0.1 * i},
        {0.95 + 0.2 * i, 0.45 - 0.2 * i, -1.2 + 0.5 * i});
  put("frosted slab", slab, {.roughness = 0.25, .thickness_m = 0.1, .attenuation = {0.5, 0.8, 0.7}}, {1.4, -0.5, 0.5});
  put("ball", out.primitive(sphere(0.4, 64, 48)), {.thickness_m = 0.8}, {-0.1, -0.25, 0.1});
  Shape flat = sphere(0.4, 64, 48);
  for (auto& p : flat.position) p.z *= 0.3;
  for (auto& n : flat.normal) n = glm::normalize(n / glm::dvec3(1, 1, 0.3));
  put("lens", out.primitive(flat), {.color = {1, 0.9, 0.8}, .thickness_m = 0.2}, {-0.05, 0.35, 0.6});
  out.camera_node({0, 0, 4.2}, {0, 0, 0}, 0.5);
}

// A sun and a lamp through coloured sheets onto a floor and a wall: glass over each other, one blended sheet, and a
// post before and one behind them.
void make_stained(GlbWriter& out, SceneOptions&) {
  const int plaster = out.material("plaster", pbr({0.75, 0.75, 0.72, 1}, 0, 1));
  const auto put = [&](std::string_view name, const json& shape, int material, glm::dvec3 at) {
    out.node(name, {{"mesh", out.mesh(name, shape, material)}, {"translation", vector_json(at)}});
  };
  put("floor", out.primitive(ground(6, 1, 1)), plaster, {0, 0, 0});
  put("wall", out.primitive(quad(6, 3)), plaster, {0, 1.5, -2});
  const json post = out.primitive(box({0.1, 0.9, 0.1}));
  const int wood = out.material("wood", pbr({0.5, 0.35, 0.2, 1}, 0, 1));
  put("post before", post, wood, {-0.7, 0.45, 1.1});
  put("post behind", post, wood, {0.6, 0.45, -0.5});
  const glm::dvec3 colors[] = {{1, 0.25, 0.2}, {0.3, 0.85, 0.35}, {0.3, 0.45, 1}};
  const json sheet = out.primitive(quad(0.9, 0.9));
  for (int i = 0; i < 3; ++i)
    put("sheet", sheet, glass(out, "sheet", {.color = colors[i]}), {-0.7 + 0.6 * i, 0.75 + 0.15 * i, 0.5 - 0.25 * i});
  json haze = pbr({0.4, 0.4, 0.45, 0.5}, 0, 1);
  haze["alphaMode"] = "BLEND";
  haze["doubleSided"] = true;
  put("haze", sheet, out.material("haze", haze), {1.35, 0.6, 0.2});
  add_sun(out, {0.25, 1.6, 1.7}, {1, 0.97, 0.9}, 3);
  add_point_light(out, {1.6, 1.2, 2.2}, {0.7, 0.85, 1}, 4);
  out.camera_node({0.3, 1.7, 4.2}, {0.1, 0.45, -0.5}, 0.65);
}

// Light that a ball, a lens and a slab of glass bend onto a floor.
void make_caustics(GlbWriter& out, SceneOptions&) {
  const auto put = [&](std::string_view name, const json& shape, int material, glm::dvec3 at) {
    out.node(name, {{"mesh", out.mesh(name, shape, material)}, {"translation", vector_json(at)}});
  };
  put("floor", out.primitive(ground(6, 1, 1)), out.material("plaster", pbr({0.7, 0.7, 0.68, 1}, 0, 1)), {0, 0, 0});
  put("ball", out.primitive(sphere(0.3, 96, 64)), glass(out, "ball", {.thickness_m = 0.6}), {-0.75, 0.32, 0});
  Shape lens = sphere(0.35, 96, 64);
  for (auto& p : lens.position) p.y *= 0.3;
  for (auto& n : lens.normal) n = glm::normalize(n / glm::dvec3(1, 0.3, 1));
  put("lens", out.primitive(lens), glass(out, "lens", {.color = {1, 0.8, 0.5}, .thickness_m = 0.2}), {0.1, 0.6, 0.1});
  put("slab", out.primitive(box({0.5, 0.12, 0.5})),
      glass(out, "slab", {.thickness_m = 0.12, .attenuation = {0.3, 0.75, 0.6}, .distance_m = 0.1}), {0.95, 0.25, 0});
  add_sun(out, {0.3, 2, 0.5}, {1, 0.97, 0.9}, 3);
  out.camera_node({0, 2.2, 2.4}, {0, 0.15, 0}, 0.6);
}

}  // namespace candela
