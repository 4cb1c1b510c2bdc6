#include <array>
#include <numbers>

#include "math/transforms.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {

namespace {
using std::numbers::pi;
constexpr int nearest = 9728, linear = 9729, linear_mipmap_linear = 9987;
constexpr int clamp_to_edge = 33071, mirrored_repeat = 33648, repeat = 10497;

// A texture whose orientation can be read off: red grows to the right, green downwards, and a white corner at u = v =
// 0.
std::vector<std::byte> orientation_png(int size) {
  return png_from(size, size, 3, [](double u, double v) {
    if (u < 0.25 && v < 0.25) return glm::dvec4(1);
    const bool odd = (int(u * 8) + int(v * 8)) % 2 != 0;
    return glm::dvec4(u, v, odd ? 0.5 : 0.1, 1);
  });
}
}  // namespace

void make_unlit_box(GlbWriter& out, SceneOptions&) {
  out.use_extension("KHR_materials_unlit");
  const int texture = out.texture("checker", checker_png(64, 8, {0.12, 0.2, 0.5}, {0.95, 0.8, 0.3}));
  json material = pbr_textured(texture, 0, 1);
  material["extensions"]["KHR_materials_unlit"] = json::object();
  const int mesh = out.mesh("box", out.primitive(box({1, 1, 1})), out.material("unlit", material));
  out.node("box", {{"mesh", mesh}, {"rotation", quaternion_json(rotation_about({0, 1, 0}, 0.5))}});
  out.camera_node({1.2, 1.3, 2.2}, {0, 0, 0}, 0.7);
}

void make_spheres(GlbWriter& out, SceneOptions&) {
  const json ball = out.primitive(sphere(0.45, 32, 20));
  constexpr std::array roughness{0.05, 0.25, 0.5, 0.75, 1.0};
  for (int row = 0; row < 3; ++row)
    for (size_t column = 0; column < roughness.size(); ++column) {
      const double metallic = row * 0.5;
      const std::string name =
          "metallic " + std::to_string(row * 50) + "%, roughness " + std::to_string(int(roughness[column] * 100)) + "%";
      const int material = out.material(name, pbr({0.9, 0.35 + 0.15 * row, 0.2, 1}, metallic, roughness[column]));
      out.node(name, {{"mesh", out.mesh(name, ball, material)},
                      {"translation", vector_json({double(column) - 2, row + 0.5, 0})}});
    }
  const int floor =
      out.mesh("floor", out.primitive(ground(12, 1, 1)), out.material("floor", pbr({0.4, 0.42, 0.45, 1}, 0, 0.6)));
  out.node("floor", {{"mesh", floor}});
  const int wall = out.mesh("wall", out.primitive(quad(12, 5)), out.material("wall", pbr({0.5, 0.5, 0.5, 1}, 0, 0.9)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 2.5, -2})}});
  add_sun(out, {1, 2, 2}, {1, 0.95, 0.85}, 1.5);
  add_point_light(out, {-2.5, 2, 2}, {0.3, 0.5, 1}, 12);
  const int spot = out.light({{"type", "spot"},
                              {"color", vector_json({0.4, 1, 0.5})},
                              {"intensity", 40},
                              {"range", 10},
                              {"spot", {{"innerConeAngle", 0.15}, {"outerConeAngle", 0.35}}}});
  const glm::dvec3 at{3, 4, 3};
  const glm::dquat aim = glm::quat_cast(glm::dmat3(look_at_pose(at, {1.5, 1, 0})));
  out.node("spot", {{"translation", vector_json(at)},
                    {"rotation", quaternion_json(aim)},
                    {"extensions", {{"KHR_lights_punctual", {{"light", spot}}}}}});
  out.camera_node({0, 1.8, 6}, {0, 1.4, 0}, 0.6);
}

void make_alpha(GlbWriter& out, SceneOptions&) {
  const int floor_texture = out.texture("checker", checker_png(32, 8, {0.15, 0.15, 0.15}, {0.85, 0.85, 0.85}));
  const int wall =
      out.mesh("wall", out.primitive(quad(6, 4)), out.material("wall", pbr_textured(floor_texture, 0, 0.9)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 0, -1.5})}});

  const int petals =
      out.texture("petals", png_from(64, 64, 4, [](double u, double v) {
                    const double x = 2 * u - 1, y = 2 * v - 1, radius = std::hypot(x, y), angle = std::atan2(y, x);
                    const double edge = 0.6 + 0.3 * std::cos(5 * angle);
                    return glm::dvec4(0.9, 0.3 + 0.5 * radius, 0.2, smooth_step(edge + 0.1, edge - 0.1, radius));
                  }));
  const json card = out.primitive(quad(1.2, 1.2));
  const struct {
    const char* mode;
    double cutoff;
  } cards[] = {{"OPAQUE", 0}, {"MASK", 0.25}, {"MASK", 0.75}, {"BLEND", 0}};
  double x = -2.1;
  for (const auto& [mode, cutoff] : cards) {
    json material = pbr_textured(petals, 0, 0.6);
    material["alphaMode"] = mode;
    material["doubleSided"] = true;
    if (cutoff > 0) material["alphaCutoff"] = cutoff;
    const int mesh = out.mesh(mode, card, out.material(mode, material));
    out.node(mode, {{"mesh", mesh},
                    {"translation", vector_json({x, 0.8, 0})},
                    {"rotation", quaternion_json(rotation_about({0, 1, 0}, x > 0 ? pi : 0))}});
    x += 1.4;
  }
  // Panes written nearest first, so that only sorting gives the right picture.
  const json pane = out.primitive(quad(1.0, 1.0));
  const std::array<glm::dvec3, 5> colors{
      {{1, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.2, 0.3, 1}, {1, 0.9, 0.1}, {0.9, 0.2, 0.9}}};
  for (size_t i = 0; i < colors.size(); ++i) {
    json material = pbr({colors[i], 0.5}, 0, 0.5);
    material["alphaMode"] = "BLEND";
    const int mesh = out.mesh("pane", pane, out.material("pane", material));
    out.node("pane", {{"mesh", mesh},
                      {"translation",
                       vector_json({-1.2 + 0.55 * double(i), -0.75 + 0.1 * double(i % 2), 1.0 - 0.4 * double(i)})}});
  }
  add_sun(out, {0.5, 1, 2}, {1, 1, 1}, 3);
  out.camera_node({0, 0, 5}, {0, 0, 0}, 0.8);
}

void make_normal_mapped(GlbWriter& out, SceneOptions&) {
  const int bumps = out.texture("bumps", normal_map_from(64, 60, [](double u, double v) {
                                  const double s = std::sin(4 * pi * u) * std::sin(4 * pi * v);
                                  return 0.03 * s * s + 0.01 * std::sin(2 * pi * (u + 2 * v));
                                }));
  json material = pbr({0.7, 0.6, 0.5, 1}, 0, 0.45);
  material["normalTexture"] = {{"index", bumps}, {"scale", 1}};
  const int bumpy = out.material("bumpy", material);
  material["normalTexture"]["scale"] = 0.4;
  const int softer = out.material("softer", material);

  Shape mirrored = quad(1.4, 1.4);
  for (glm::dvec2& uv : mirrored.uv) uv.x = 1 - uv.x;
  out.node("quad", {{"mesh", out.mesh("quad", out.primitive(quad(1.4, 1.4)), bumpy)},
                    {"translation", vector_json({-1.6, 0.8, 0})}});
  out.node("mirrored uv", {{"mesh", out.mesh("mirrored uv", out.primitive(mirrored), bumpy)},
                           {"translation", vector_json({0, 0.8, 0})}});
  out.node("softer", {{"mesh", out.mesh("softer", out.primitive(quad(1.4, 1.4)), softer)},
                      {"translation", vector_json({1.6, 0.8, 0})}});
  const int ball = out.mesh("ball", out.primitive(sphere(0.7, 32, 20, {2, 1})), bumpy);
  out.node("ball", {{"mesh", ball}, {"translation", vector_json({-0.9, -0.8, 0})}});
  // A negative scale turns both the winding and the handedness of the tangent space.
  out.node("mirrored ball",
           {{"mesh", ball}, {"translation", vector_json({0.9, -0.8, 0})}, {"scale", vector_json({-1, 1, 1})}});
  add_sun(out, {-2, 2, 2}, {1, 1, 0.95}, 3);
  out.camera_node({0, 0, 5}, {0, 0, 0}, 0.75);
}

void make_texture_transform(GlbWriter& out, SceneOptions&) {
  out.use_extension("KHR_texture_transform");
  out.use_extension("KHR_materials_unlit");
  const std::vector<std::byte> png = orientation_png(32);
  const auto texture = [&](int wrap_u, int wrap_v, int mag, int min) {
    return out.texture("orientation", png,
                       {{"wrapS", wrap_u}, {"wrapT", wrap_v}, {"magFilter", mag}, {"minFilter", min}});
  };
  const int repeated = texture(repeat, repeat, linear, linear_mipmap_linear);
  const int clamped = texture(clamp_to_edge, repeat, nearest, nearest);
  const int mirrored = texture(mirrored_repeat, clamp_to_edge, nearest, linear);

  Shape shape = quad(1, 1);
  json card = out.primitive(shape);
  for (glm::dvec2& uv : shape.uv) uv = glm::dvec2(uv.y, uv.x) * 2.0;
  std::vector<double> second;
  for (glm::dvec2 uv : shape.uv) second.insert(second.end(), {uv.x, uv.y});
  card["attributes"]["TEXCOORD_1"] = out.float_accessor(second, 2);

  const auto transform = [](glm::dvec2 offset, double rotation, glm::dvec2 scale) {
    return json{{"offset", vector_json({offset.x, offset.y})},
                {"rotation", number(rotation)},
                {"scale", vector_json({scale.x, scale.y})}};
  };
  const struct {
    const char* name;
    int texture;
    json transform;
    int uv_set;
  } cards[] = {
      {"plain", repeated, json(), 0},
      {"offset", repeated, transform({0.25, 0.5}, 0, {1, 1}), 0},
      {"rotation", repeated, transform({0, 0}, 0.6, {1, 1}), 0},
      {"scale", repeated, transform({0, 0}, 0, {2, 3}), 0},
      {"clamp", clamped, transform({-0.5, 0.2}, 0.3, {2, 2}), 0},
      {"mirror", mirrored, transform({-0.5, -0.5}, -0.4, {3, 2}), 0},
      {"second uv set", repeated, json(), 1},
      {"second set, transformed", mirrored, transform({0.3, 0}, 1.2, {0.7, 1.5}), 1},
  };
  int i = 0;
  for (const auto& entry : cards) {
    json material = pbr_textured(entry.texture, 0, 1);
    json& slot = material["pbrMetallicRoughness"]["baseColorTexture"];
    if (entry.uv_set != 0) slot["texCoord"] = entry.uv_set;
    if (!entry.transform.is_null()) slot["extensions"]["KHR_texture_transform"] = entry.transform;
    material["extensions"]["KHR_materials_unlit"] = json::object();
    const int mesh = out.mesh(entry.name, card, out.material(entry.name, material));
    out.node(entry.name,
             {{"mesh", mesh}, {"translation", vector_json({(i % 4) * 1.1 - 1.65, i < 4 ? 0.55 : -0.55, 0})}});
    ++i;
  }
  out.camera_node({0, 0, 4}, {0, 0, 0}, 0.62);
}

void make_emissive_strength(GlbWriter& out, SceneOptions&) {
  out.use_extension("KHR_materials_emissive_strength");
  const json panel = out.primitive(quad(0.9, 1.6));
  const std::array strengths{0.25, 1.0, 4.0, 16.0};
  for (size_t i = 0; i < strengths.size(); ++i) {
    json material = pbr({0, 0, 0, 1}, 0, 1);
    material["emissiveFactor"] = vector_json({1, 0.6, 0.25});
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strengths[i]}};
    const int mesh = out.mesh("panel", panel, out.material("panel", material));
    out.node("panel", {{"mesh", mesh}, {"translation", vector_json({double(i) - 1.5, 0, 0})}});
  }
  const int wall = out.mesh("wall", out.primitive(quad(6, 4)), out.material("wall", pbr({0.3, 0.3, 0.35, 1}, 0, 0.9)));
  out.node("wall", {{"mesh", wall}, {"translation", vector_json({0, 0, -0.5})}});
  add_point_light(out, {0, 1.5, 1.5}, {0.5, 0.6, 1}, 3);
  out.camera_node({0, 0, 4}, {0, 0, 0}, 0.62);
}

}  // namespace candela
