#include <array>
#include <numbers>

#include "math/transforms.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {

namespace {
using std::numbers::pi;

json with_lobe(GlbWriter& out, json material, const std::string& name, json values) {
  out.use_extension("KHR_materials_" + name);
  material["extensions"]["KHR_materials_" + name] = std::move(values);
  return material;
}

// All of them on one material, each by a texture.
json stacked(GlbWriter& out, double factor) {
  const auto of = [&](const char* name, const std::function<glm::dvec4(double, double)>& color, int channels = 3) {
    return json{{"index", out.texture(name, png_from(32, 32, channels, color))}};
  };
  const auto stripes = [](double v) { return 0.5 + 0.5 * std::sin(8 * pi * v); };
  json material = pbr({0.5, 0.25, 0.15, 1}, 0.6, 0.5);
  json coat = {{"clearcoatFactor", factor}, {"clearcoatRoughnessFactor", 1}};
  coat["clearcoatTexture"] = of("coat", [&](double, double v) { return glm::dvec4(1 - 0.7 * stripes(v), 0, 0, 1); });
  coat["clearcoatRoughnessTexture"] =
      of("coat roughness", [](double u, double) { return glm::dvec4(0, 0.1 + 0.5 * u, 0, 1); });
  coat["clearcoatNormalTexture"] = {
      {"index", out.texture("coat normals", normal_map_from(32, 20,
                                                            [](double u, double v) {
                                                              return 0.03 * std::sin(4 * pi * u) * std::sin(4 * pi * v);
                                                            }))},
      {"scale", 0.5}};
  material = with_lobe(out, material, "clearcoat", coat);
  json sheen = {{"sheenColorFactor", {factor, factor, factor}}, {"sheenRoughnessFactor", 1}};
  sheen["sheenColorTexture"] = of("sheen", [](double u, double v) { return glm::dvec4(0.2, 0.3 + 0.5 * u, v, 1); });
  sheen["sheenRoughnessTexture"] = of(
      "sheen roughness", [](double, double v) { return glm::dvec4(0, 0, 0, 0.3 + 0.5 * v); }, 4);
  material = with_lobe(out, material, "sheen", sheen);
  json film = {{"iridescenceFactor", 1},
               {"iridescenceIor", 1.4},
               {"iridescenceThicknessMinimum", 200},
               {"iridescenceThicknessMaximum", 600}};
  film["iridescenceTexture"] = of("film", [&](double u, double) { return glm::dvec4(stripes(u), 0, 0, 1); });
  film["iridescenceThicknessTexture"] = of("film thickness", [](double, double v) { return glm::dvec4(0, v, 0, 1); });
  material = with_lobe(out, material, "iridescence", film);
  json anisotropy = {{"anisotropyStrength", 0.8}, {"anisotropyRotation", factor}};
  anisotropy["anisotropyTexture"] = of("anisotropy", [](double u, double v) {
    const double angle = 2 * pi * u;
    return glm::dvec4(0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle), 0.3 + 0.7 * v, 1);
  });
  material = with_lobe(out, material, "anisotropy", anisotropy);
  json passing = {{"diffuseTransmissionFactor", 0.8}};
  passing["diffuseTransmissionTexture"] = of(
      "passing", [&](double u, double) { return glm::dvec4(0, 0, 0, 0.5 + 0.5 * stripes(u)); }, 4);
  passing["diffuseTransmissionColorTexture"] =
      of("passing color", [](double u, double v) { return glm::dvec4(0.9, u, v, 1); });
  return with_lobe(out, material, "diffuse_transmission", passing);
}
}  // namespace

// A row a lobe, its factor rising from left to right; at the bottom all of them, textured.
void make_lobes(GlbWriter& out, SceneOptions&) {
  constexpr std::array factors{0.0, 0.25, 0.5, 0.75, 1.0};
  const json ball = out.primitive(with_tangents(sphere(0.42, 32, 20))), card = out.primitive(quad(0.8, 0.8));
  for (size_t column = 0; column < factors.size(); ++column) {
    const double f = factors[column];
    const struct {
      const char* name;
      json material;
      bool flat = false;
    } rows[] = {
        {"clear coat", with_lobe(out, pbr({0.6, 0.05, 0.04, 1}, 0.5, 0.6), "clearcoat",
                                 {{"clearcoatFactor", f}, {"clearcoatRoughnessFactor", 0.1}})},
        {"sheen", with_lobe(out, pbr({0.05, 0.06, 0.2, 1}, 0, 0.9), "sheen",
                            {{"sheenColorFactor", {f, 0.7 * f, 0.4 * f}}, {"sheenRoughnessFactor", 0.35}})},
        {"film",
         with_lobe(
             out, pbr({0.9, 0.9, 0.9, 1}, f, 0.25), "iridescence",
             {{"iridescenceFactor", 1}, {"iridescenceIor", 1.33}, {"iridescenceThicknessMaximum", 250 + 300 * f}})},
        {"anisotropy", with_lobe(out, pbr({0.8, 0.7, 0.5, 1}, 1, 0.35), "anisotropy",
                                 {{"anisotropyStrength", f}, {"anisotropyRotation", 0.5}})},
        {"passing light",
         with_lobe(out, pbr({0.3, 0.6, 0.2, 1}, 0, 0.6), "diffuse_transmission",
                   {{"diffuseTransmissionFactor", f}, {"diffuseTransmissionColorFactor", {0.9, 0.8, 0.2}}}),
         true},
        {"all", stacked(out, f)},
    };
    double y = 5.5;
    for (const auto& [name, given, flat] : rows) {
      json material = given;
      if (flat) material["doubleSided"] = true;
      const std::string full = std::string(name) + " " + std::to_string(int(100 * f)) + "%";
      out.node(full, {{"mesh", out.mesh(full, flat ? card : ball, out.material(full, material))},
                      {"translation", vector_json({double(column) - 2, y, 0})}});
      y -= 1;
    }
  }
  const int wall = out.mesh("wall", out.primitive(quad(12, 9)), out.material("wall", pbr({0.5, 0.5, 0.5, 1}, 0, 0.9)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 3, -3})}});
  add_sun(out, {1, 2, 3}, {1, 0.95, 0.85}, 1.5);
  add_point_light(out, {-3, 4, 2}, {0.5, 0.7, 1}, 12);
  add_point_light(out, {0.3, 1.6, -1}, {1, 0.9, 0.8}, 6);
  out.camera_node({0, 3, 9}, {0, 3, 0}, 0.68);
}

}  // namespace candela
