// Materials: mirrors, grazing views, colours outside [0,1], light of their own. Textures: of one texel, of one row, far
// coordinates, skies that hold what no light has.
#include "stability/stage.h"
#include "testscenes/procedural_textures.h"

namespace candela::stability {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

json with_extension(json material, std::string_view name, json value) {
  material["extensions"][std::string(name)] = std::move(value);
  return material;
}

// A ball of the material over the room's floor, near the light.
void add_ball(Recipes& all, std::string name, std::string what, json material, double bound = 1e-3,
              std::string extension = {}) {
  all.push_back({"materials", std::move(name), std::move(what), [=](StabilityInput& in) {
                   GlbWriter out;
                   lit_room(out, in.rng);
                   if (!extension.empty()) out.use_extension(extension);
                   place(out, sphere(0.6, 64, 48), material, {0, 0.75, 1.5});
                   StabilityScene scene = scene_of(out);
                   scene.bound = bound;
                   return scene;
                 }});
}

StabilityScene grazing(double height_m, double roughness, double metallic) {
  GlbWriter out;
  place(out, ground(40, 1, 1), lit({0.8, 0.8, 0.8}, metallic, roughness), {0, 0, 0});
  point(out, {0, 0.5, -8}, 20);
  sun(out, {0.1, 0.01, -1}, 1);
  camera(out, {0, height_m, 10}, {0, 0, -4}, 0.3, 0.01);
  return scene_of(out);
}

StabilityScene colored(StabilityInput& in, double factor) {
  GlbWriter out;
  lit_room(out, in.rng);
  Shape ball = sphere(0.6, 64, 48);
  for (size_t i = 0; i < ball.position.size(); ++i) ball.color.push_back({factor, factor / 2, factor * 2, 1});
  place(out, ball, lit({1, 1, 1}, 0, 0.5), {0, 0.75, 1.5});
  return scene_of(out);
}

// Devices decode sRGB within half a code value's width, not exactly: 0.3 % of lavapipe's texels.
StabilityScene textured(StabilityInput& in, std::vector<std::byte> png, json slot_more, glm::dvec2 uv_scale) {
  GlbWriter out;
  lit_room(out, in.rng);
  const int texture = out.texture("texture", png, {{"magFilter", 9728}, {"minFilter", 9728}});
  json material = lit({1, 1, 1}, 0, 0.8);
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", texture}};
  if (!slot_more.empty()) {
    out.use_extension("KHR_texture_transform");
    material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {{"KHR_texture_transform", slot_more}};
  }
  place(out, quad(1.5, 1.5, uv_scale), material, {0, 0.9, 1.5});
  StabilityScene scene = scene_of(out);
  scene.bound = 5e-3;
  scene.energy_bound = 2e-3;
  return scene;
}

StabilityScene normal_mapped(StabilityInput& in, glm::dvec4 texel, double scale, double bound) {
  GlbWriter out;
  lit_room(out, in.rng);
  const int texture = out.texture("normals", png_from(2, 2, 3, [=](double, double) { return texel; }));
  json material = lit({0.8, 0.8, 0.8}, 0, 0.6);
  material["normalTexture"] = {{"index", texture}, {"scale", scale}};
  place(out, sphere(0.6, 64, 48), material, {0, 0.75, 1.5});
  StabilityScene scene = scene_of(out);
  scene.bound = bound;
  return scene;
}

StabilityScene under(StabilityInput& in, FloatImage sky, bool warns) {
  GlbWriter out;
  room(out, in.rng);
  room_camera(out);
  StabilityScene scene = scene_of(out);
  scene.sky = std::move(sky);
  scene.warns = warns;
  scene.bound = 2e-3;  // the sky behind is filtered by the device's eight-bit fractions
  return scene;
}

FloatImage day() {
  return sky_image(64, 32, [](int, int y) { return glm::vec3(0.3f, 0.5f, 0.9f) * (1.2f - float(y) / 40); });
}
// A texel that is no light stands for 0, one that is infinite for the brightest that half holds.
FloatImage with_texel(FloatImage sky, float value) {
  for (Channel& channel : sky.channels) channel.f[size_t(10 * 64 + 20)] = value;
  return sky;
}
StabilityScene under_bad_texel(StabilityInput& in, float value, float stands_for) {
  StabilityScene scene = under(in, with_texel(day(), value), true);
  scene.plain = scene.file;
  scene.plain_sky = with_texel(day(), stands_for);
  scene.plain_bound = 0;
  scene.reference = false;
  return scene;
}

}  // namespace

void add_materials(Recipes& all) {
  add_ball(all, "roughness 0", "a dielectric mirror: its highlight is 32-bit arithmetic's place",
           lit({0.5, 0.5, 0.5}, 0, 0));
  add_ball(all, "metal mirror", "roughness 0, metallic 1", lit({0.95, 0.9, 0.8}, 1, 0));
  add_ball(all, "roughness 1e-4", "", lit({0.95, 0.9, 0.8}, 0.5, 1e-4));
  all.push_back(
      {"materials", "grazing at 1 cm over 10 m", "rough", [](StabilityInput&) { return grazing(0.01, 0.7, 0); }});
  all.push_back({"materials", "grazing mirror", "a metal mirror seen along its plane",
                 [](StabilityInput&) { return grazing(0.01, 0, 1); }});
  all.push_back({"materials", "grazing at 0.1 mm over 10 m", "cosines of 1e-5",
                 [](StabilityInput&) { return grazing(1e-4, 0.5, 0); }});
  add_ball(all, "black", "base colour 0: only its gloss is seen", lit({0, 0, 0}, 0, 0.4));
  add_ball(all, "black metal", "nothing but grazing light", lit({0, 0, 0}, 1, 0.4));
  all.push_back({"materials", "albedo above one", "vertex colours of 4 and 8",
                 [](StabilityInput& in) { return colored(in, 4); }});
  all.push_back({"materials", "albedo 1e6", "vertex colours", [](StabilityInput& in) {
                   StabilityScene scene = colored(in, 1e6);
                   scene.clamps = true;
                   return scene;
                 }});
  all.push_back({"materials", "negative albedo", "vertex colours of -1 are taken as 0", [](StabilityInput& in) {
                   StabilityScene scene = colored(in, -1);
                   return scene;
                 }});
  for (const auto& [name, strength, samples] :
       {std::tuple("emissive 1e8", 1e8, 1), std::tuple("emissive 1e38", 1e38, 1),
        std::tuple("emissive 2e38, 4 samples", 2e38, 4)})
    all.push_back({"materials", name, "KHR_materials_emissive_strength", [=](StabilityInput& in) {
                     json material = lit({0.5, 0.5, 0.5}, 0, 0.5);
                     material["emissiveFactor"] = {1, 0.5, 0.25};
                     GlbWriter out;
                     lit_room(out, in.rng);
                     out.use_extension("KHR_materials_emissive_strength");
                     place(
                         out, sphere(0.6, 64, 48),
                         with_extension(material, "KHR_materials_emissive_strength", {{"emissiveStrength", strength}}),
                         {0, 0.75, 1.5});
                     StabilityScene scene = scene_of(out);
                     scene.clamps = true;
                     scene.job.samples = samples;
                     scene.reference = samples == 1;
                     return scene;
                   }});
  const json grey = lit({0.5, 0.5, 0.5}, 0, 0.3);
  add_ball(all, "ior 0", "f0 = 1", with_extension(grey, "KHR_materials_ior", {{"ior", 0}}), 1e-3, "KHR_materials_ior");
  add_ball(all, "ior 1", "f0 = 0", with_extension(grey, "KHR_materials_ior", {{"ior", 1}}), 1e-3, "KHR_materials_ior");
  add_ball(all, "ior 1e6", "f0 near 1", with_extension(grey, "KHR_materials_ior", {{"ior", 1e6}}), 1e-3,
           "KHR_materials_ior");
  add_ball(all, "specular colour 1e6", "f0 stops at 1",
           with_extension(grey, "KHR_materials_specular", {{"specularColorFactor", {1e6, 1, 0}}}), 1e-3,
           "KHR_materials_specular");
  all.push_back({"materials", "normal map of zero", "(127.5, 127.5, 127.5): no direction", [](StabilityInput& in) {
                   return normal_mapped(in, {0.5, 0.5, 0.5, 1}, 1, 1e-3);
                 }});
  all.push_back({"materials", "normal scale 1e6", "normals in the surface's plane", [](StabilityInput& in) {
                   return normal_mapped(in, {0.7, 0.6, 0.9, 1}, 1e6, 1e-3);
                 }});
  all.push_back({"materials", "normal scale 1e30", "its square is no float", [](StabilityInput& in) {
                   return normal_mapped(in, {0.7, 0.6, 0.9, 1}, 1e30, 1e-3);
                 }});
  all.push_back({"materials", "normal scale 0", "as without a map", [](StabilityInput& in) {
                   return normal_mapped(in, {0.7, 0.6, 0.9, 1}, 0, 1e-3);
                 }});
}

void add_textures(Recipes& all) {
  const auto stripes = [](double u, double v) {
    return glm::dvec4(0.2 + 0.6 * (int(u * 8) % 2), 0.2 + 0.6 * (int(v * 8) % 2), 0.5, 1);
  };
  all.push_back({"textures", "1x1", "one texel", [=](StabilityInput& in) {
                   return textured(in, png_from(1, 1, 3, stripes), {}, {1, 1});
                 }});
  // Nearest texels: an edge between two moves by rounding, so it may fall on either side of a sample.
  all.push_back({"textures", "16384x1", "one row", [=](StabilityInput& in) {
                   StabilityScene scene = textured(in, png_from(16384, 1, 3, stripes), {}, {1, 1});
                   return scene;
                 }});
  all.push_back({"textures", "1x16384", "one column", [=](StabilityInput& in) {
                   StabilityScene scene = textured(in, png_from(1, 16384, 3, stripes), {}, {1, 1});
                   return scene;
                 }});
  all.push_back({"textures", "16385x1", "wider than devices take: left out, with a warning", [=](StabilityInput& in) {
                   StabilityScene scene = textured(in, png_from(16385, 1, 3, stripes), {}, {1, 1});
                   scene.warns = true;
                   return scene;
                 }});
  all.push_back({"textures", "coordinates of 1e6", "the fraction has four bits left", [=](StabilityInput& in) {
                   StabilityScene scene = textured(in, png_from(1, 1, 3, stripes), {}, {1e6, 1e6});
                   return scene;
                 }});
  all.push_back({"textures", "coordinates of 1e30", "whole numbers, all of them", [=](StabilityInput& in) {
                   return textured(in, png_from(1, 1, 3, stripes), {}, {1e30, 1e30});
                 }});
  all.push_back({"textures", "transform of scale 0", "one texel over the square", [=](StabilityInput& in) {
                   return textured(in, png_from(8, 8, 3, stripes), {{"scale", {0, 0}}, {"offset", {0.3, 0.3}}}, {1, 1});
                 }});
  all.push_back({"textures", "NaN in the sky", "one texel; it stands for 0, with a warning",
                 [](StabilityInput& in) { return under_bad_texel(in, nan, 0); }});
  all.push_back({"textures", "infinity in the sky", "one texel; it stands for 65504, with a warning",
                 [](StabilityInput& in) { return under_bad_texel(in, infinity, 65504); }});
  all.push_back({"textures", "negative sky", "one texel; it stands for 0, with a warning",
                 [](StabilityInput& in) { return under_bad_texel(in, -5, 0); }});
  all.push_back({"textures", "sky of one texel", "constant light", [](StabilityInput& in) {
                   StabilityScene scene = under(in, sky_image(1, 1, [](int, int) { return glm::vec3(0.7f); }), false);
                   scene.plain = scene.file;
                   scene.plain_sky = sky_image(256, 128, [](int, int) { return glm::vec3(0.7f); });
                   scene.plain_bound = 1e-2;  // sixty-four directions round the horizon against 256
                   scene.energy_bound = 5e-3;
                   return scene;
                 }});
  all.push_back({"textures", "sky of 1e-30", "", [](StabilityInput& in) {
                   return under(in, sky_image(8, 4, [](int, int) { return glm::vec3(1e-30f); }), false);
                 }});
  all.push_back({"textures", "sky of 3e38", "sums of it are no floats", [](StabilityInput& in) {
                   StabilityScene scene = under(
                       in, sky_image(64, 32, [](int x, int y) { return glm::vec3(x == 20 && y == 10 ? 3e38f : 1.0f); }),
                       false);
                   scene.clamps = true;
                   scene.reference = false;  // one sample of the background hits or misses the texel's filtered edge
                   return scene;
                 }});
}

}  // namespace candela::stability
