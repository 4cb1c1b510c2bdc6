#include "testscenes/mesh_kit.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela {
namespace {

// The room: x, y and z from these to these.
constexpr glm::dvec3 low(-3, 0, -4), high(3, 3, 4);

// Its walls, each with a border and a stripe of another shade, so that a reflection shows where it is.
std::vector<std::byte> panels_png() {
  return png_from(256, 256, 3, [](double u, double v) {
    const double across = u * 4 - int(u * 4), border = std::min(std::min(across, 1 - across), std::min(v, 1 - v));
    const double shade = border < 0.04 ? 0.35 : v > 0.62 && v < 0.68 ? 0.55 : 1;
    return glm::dvec4(glm::dvec3(shade), 1);
  });
}

void add_ball(GlbWriter& out, const json& ball, std::string_view name, glm::dvec3 at, double radius, const json& pbr) {
  out.node(name, {{"mesh", out.mesh(name, ball, out.material(name, pbr))},
                  {"translation", vector_json(at)},
                  {"scale", vector_json(glm::dvec3(radius))}});
}

}  // namespace

// For reflections of what stands about: a closed room with a polished floor, walls of different colours and balls of
// metal, under two lamps and a panel of light.
void make_room(GlbWriter& out, SceneOptions&) {
  const int panels = out.texture("panels", panels_png());
  const auto wall = [&](std::string_view name, glm::dvec3 color) {
    json m = pbr_textured(panels, 0, 0.9);
    m["pbrMetallicRoughness"]["baseColorFactor"] = vector_json({color.x, color.y, color.z, 1});
    return Paint{out.material(name, m)};
  };
  const Paint red = wall("red", {0.75, 0.09, 0.05}), blue = wall("blue", {0.06, 0.2, 0.65});
  const Paint white = wall("white", {0.75, 0.72, 0.65}), green = wall("green", {0.12, 0.45, 0.1});
  const Paint ceiling{out.material("ceiling", pbr({0.7, 0.7, 0.7, 1}, 0, 0.95))};
  const Paint floor{out.material("floor", pbr({0.5, 0.48, 0.45, 1}, 1, 0.15))};
  const Paint wood{out.material("wood", pbr({0.35, 0.2, 0.1, 1}, 0, 0.6))};
  json glow = pbr({0, 0, 0, 1}, 0, 1);
  glow["emissiveFactor"] = vector_json({1, 0.9, 0.75});
  glow["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = number(3);
  out.use_extension("KHR_materials_emissive_strength");
  const Paint light{out.material("panel of light", glow)};
  const glm::dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  MeshKit kit;
  const auto whole = [&](const Paint& paint, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    kit.quad(paint, corner, u, v, {0, 1}, {1, 0});
  };
  whole(floor, low + z, x, -z);
  whole(ceiling, low + y, x, z);
  whole(red, low + z, -z, y);
  whole(blue, low + x, z, y);
  whole(white, low, x, y);
  whole(green, low + x + z, -x, y);
  kit.box(light, {-1.5, 2.96, -2.4}, {1.5, 2.98, -1.9}, MeshKit::all);
  kit.box(wood, {-2.6, 0, -3.2}, {-1.8, 0.5, -2.4}, MeshKit::no_bottom);
  kit.box(wood, {1.7, 0, -2.2}, {2.5, 0.9, -1.4}, MeshKit::no_bottom);
  out.node("room", {{"mesh", kit.write(out, "room")}});
  const json ball = out.primitive(sphere(1, 64, 40));
  add_ball(out, ball, "chrome", {0, 0.75, -1}, 0.75, pbr({0.95, 0.95, 0.95, 1}, 1, 0.05));
  add_ball(out, ball, "gold", {-1.55, 0.45, 0.2}, 0.45, pbr({0.95, 0.7, 0.3, 1}, 1, 0.3));
  add_ball(out, ball, "copper", {1.5, 0.45, 0.1}, 0.45, pbr({0.9, 0.5, 0.35, 1}, 1, 0.5));
  add_ball(out, ball, "lacquer", {2.1, 1.25, -1.8}, 0.35, pbr({0.02, 0.02, 0.02, 1}, 0, 0.1));
  add_ball(out, ball, "steel", {-2.2, 0.85, -2.8}, 0.35, pbr({0.6, 0.62, 0.65, 1}, 1, 0.8));
  add_point_light(out, {-1.4, 2.5, 1.6}, {1, 0.85, 0.65}, 30);
  add_point_light(out, {1.6, 2.4, -2.6}, {0.75, 0.85, 1}, 20);
  out.camera_node({0.3, 1.35, 3.6}, {0, 0.8, -1}, 0.95);
}

}  // namespace candela
