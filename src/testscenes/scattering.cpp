#include <numbers>

#include "testscenes/table.h"

namespace candela {
namespace {

struct Body {
  glm::dvec3 color{1};  // of many scatterings
  double free_path_m = 0.05, anisotropy = 0, thickness_m = 0.6;
  glm::dvec3 entering{1};
  bool window = false;  // light enters through clear walls, else diffusely
};

int body(GlbWriter& out, std::string_view name, const Body& b) {
  json material = pbr({1, 1, 1, 1}, 0, b.window ? 0.0 : 0.5);
  const auto extend = [&](const std::string& extension, json object) {
    out.use_extension(extension);
    material["extensions"][extension] = std::move(object);
  };
  if (b.window) {
    extend("KHR_materials_transmission", {{"transmissionFactor", 1}});
    extend("KHR_materials_ior", {{"ior", 1.33}});
  } else {
    extend("KHR_materials_diffuse_transmission",
           {{"diffuseTransmissionFactor", 1}, {"diffuseTransmissionColorFactor", vector_json(b.entering)}});
  }
  const double left = 1 / std::numbers::e;  // after one free path
  extend("KHR_materials_volume", {{"thicknessFactor", number(b.thickness_m)},
                                  {"attenuationColor", vector_json({left, left, left})},
                                  {"attenuationDistance", number(b.free_path_m)}});
  extend("KHR_materials_volume_scatter",
         {{"multiscatterColorFactor", vector_json(b.color)}, {"scatterAnisotropy", number(b.anisotropy)}});
  return out.material(name, material);
}

}  // namespace

// From dense to thin, flat and round, lit from before and from behind.
void make_scattering(GlbWriter& out, SceneOptions&) {
  const auto put = [&](std::string_view name, const json& shape, int material, glm::dvec3 at) {
    out.node(name, {{"mesh", out.mesh(name, shape, material)}, {"translation", vector_json(at)}});
  };
  put("floor", out.primitive(ground(8, 1, 1)), out.material("floor", pbr({0.4, 0.4, 0.4, 1}, 0, 0.9)), {0, 0, 0});
  const json ball = out.primitive(sphere(0.3, 48, 32)), slab = out.primitive(box({0.5, 0.6, 0.1}));
  const glm::dvec3 skin(0.8, 0.5, 0.35), leaf(0.4, 0.7, 0.2), milk(0.97, 0.95, 0.9), wax(0.9, 0.7, 0.4);
  put("skin", ball, body(out, "skin", {.color = skin, .free_path_m = 0.01}), {-1.2, 0.3, 0});
  put("wax", ball, body(out, "wax", {.color = wax, .free_path_m = 0.06, .anisotropy = 0.5}), {-0.4, 0.3, 0});
  put("milk", ball, body(out, "milk", {.color = milk, .free_path_m = 0.2}), {0.4, 0.3, 0});
  put("clouded glass", ball, body(out, "clouded glass", {.color = milk, .free_path_m = 0.4, .window = true}),
      {1.2, 0.3, 0});
  put("thin slab", slab, body(out, "thin slab", {.color = leaf, .free_path_m = 0.1, .thickness_m = 0.1}),
      {-0.8, 0.3, -0.7});
  put("dense slab", slab, body(out, "dense slab", {.color = skin, .free_path_m = 0.02, .thickness_m = 0.1}),
      {0, 0.3, -0.7});
  put("tinted slab", slab,
      body(out, "tinted slab", {.color = milk, .free_path_m = 0.05, .thickness_m = 0.1, .entering = {0.9, 0.6, 0.5}}),
      {0.8, 0.3, -0.7});
  add_sun(out, {0.4, 1, 0.7}, {1, 0.95, 0.9}, 2);
  add_point_light(out, {0.2, 1, -2}, {1, 0.8, 0.6}, 12);
  out.camera_node({0, 0.9, 3}, {0, 0.3, -0.2}, 0.55);
}

}  // namespace candela
