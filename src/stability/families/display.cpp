// Tone curves on pictures of one hot pixel, of nothing and of one value; exposures at both ends; images of odd sizes.
#include "stability/stage.h"

namespace candela::stability {
namespace {

// A square that fills the view with one radiance, and another inside it where `hot` is given.
StabilityScene flat_picture(const std::string& curve, glm::dvec3 radiance, std::optional<glm::dvec3> hot = {}) {
  GlbWriter out;
  out.use_extension("KHR_materials_unlit");
  out.use_extension("KHR_materials_emissive_strength");
  const auto glowing = [](glm::dvec3 c) {
    json material = lit({0, 0, 0}, 0, 1);
    const double top = std::max({c.x, c.y, c.z, 1.0});
    material["emissiveFactor"] = exact(c / top);
    material["extensions"] = {{"KHR_materials_emissive_strength", {{"emissiveStrength", top}}},
                              {"KHR_materials_ior", {{"ior", 1}}}};
    material["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0}};
    return material;
  };
  out.use_extension("KHR_materials_ior");
  out.use_extension("KHR_materials_specular");
  place(out, quad(8, 8), glowing(radiance), {0, 0, -2});
  // Smaller than the four pixels' distance and around one centre: one pixel of 32 by 24.
  const double pixel = 2 * 1.9 * std::tan(0.4) / 24;
  if (hot) place(out, quad(0.8 * pixel, 0.8 * pixel), glowing(*hot), {0.5 * pixel, 0.5 * pixel, -1.9});
  sun(out, {0, 0, 1}, 0);
  camera(out, {0, 0, 0}, {0, 0, -1}, 0.8, 0.01);
  StabilityScene scene = scene_of(out);
  scene.job.width_px = 32, scene.job.height_px = 24;
  scene.job.tonemap = curve;
  scene.display = true;
  return scene;
}

StabilityScene exposed(StabilityInput& in, float ev, double candela) {
  const auto fill = [&](Rng rng) {
    GlbWriter out;
    room(out, rng);
    room_camera(out);
    point(out, {-0.5, 2.5, 2.5}, candela);
    return scene_of(out);
  };
  StabilityScene scene = fill(in.rng);
  scene.plain = scene.file;
  scene.plain_job = scene.job;
  scene.job.exposure_ev = ev;
  scene.clamps = candela > 1e6;
  scene.display = true;
  return scene;
}

StabilityScene sized(StabilityInput& in, int width, int height) {
  GlbWriter out;
  lit_room(out, in.rng);
  StabilityScene scene = scene_of(out);
  scene.job.width_px = width, scene.job.height_px = height;
  // Nine traced samples for each of millions of pixels would take minutes; techniques are compared all the same.
  scene.reference = scene.display = int64_t(width) * height <= int64_t(1) << 20;
  return scene;
}

}  // namespace

void add_display(Recipes& all) {
  for (const char* curve : {"none", "agx", "reinhard", "aces", "neutral", "reinhard-luminance", "rec709", "agx-2020"}) {
    const std::string c = curve;
    all.push_back({"tone", "one pixel at 65504, " + c, "in a picture of 0.2",
                   [=](StabilityInput&) { return flat_picture(c, glm::dvec3(0.2), glm::dvec3(65504)); }});
    all.push_back({"tone", "all black, " + c, "exactly 0, in the file and on display", [=](StabilityInput&) {
                     StabilityScene scene = flat_picture(c, glm::dvec3(0));
                     scene.black = true;
                     return scene;
                   }});
    all.push_back({"tone", "all equal, " + c, "one value: one colour", [=](StabilityInput&) {
                     return flat_picture(c, {0.18, 0.18, 0.18});
                   }});
    all.push_back({"tone", "all 1e30, " + c, "white, not a hole", [=](StabilityInput&) {
                     StabilityScene scene = flat_picture(c, glm::dvec3(1e30));
                     scene.clamps = true;
                     return scene;
                   }});
    all.push_back({"tone", "1e-8 and blue of 1e4, " + c, "one channel alone",
                   [=](StabilityInput&) { return flat_picture(c, glm::dvec3(1e-8), glm::dvec3(0, 0, 1e4)); }});
  }
  all.push_back({"tone", "exposure +100 EV, 1e12 cd", "radiance times 2^100 is no float",
                 [](StabilityInput& in) { return exposed(in, 100, 1e12); }});
  all.push_back({"tone", "exposure +100 EV, 1e-6 cd", "", [](StabilityInput& in) { return exposed(in, 100, 1e-6); }});
  all.push_back({"tone", "exposure -100 EV, 1e-6 cd", "radiance times 2^-100 is below normal floats",
                 [](StabilityInput& in) { return exposed(in, -100, 1e-6); }});
  all.push_back({"tone", "exposure -100 EV, 1e9 cd", "", [](StabilityInput& in) { return exposed(in, -100, 1e9); }});
}

void add_images(Recipes& all, const std::vector<std::pair<int, int>>& sizes) {
  static const std::vector<std::pair<int, int>> own = {{1, 1}, {1, 4096}, {4096, 1}, {3, 3}, {127, 61}, {16384, 1}};
  const auto& chosen = sizes.empty() ? own : sizes;
  for (const auto& [width, height] : chosen)
    all.push_back({"images", std::to_string(width) + "x" + std::to_string(height), "",
                   [=](StabilityInput& in) { return sized(in, width, height); }});
  if (std::find(chosen.begin(), chosen.end(), std::pair(8192, 8192)) == chosen.end())
    all.push_back({"images", "8192x8192", "by --large; else 2048x2048", [](StabilityInput& in) {
                     const int side = in.large ? 8192 : 2048;
                     return sized(in, side, side);
                   }});
  all.push_back({"images", "16385x1", "refused: no device is asked for it", [](StabilityInput& in) {
                   StabilityScene scene = sized(in, 16385, 1);
                   scene.refused = true;
                   return scene;
                 }});
  all.push_back({"images", "0x0", "refused", [](StabilityInput& in) {
                   StabilityScene scene = sized(in, 0, 0);
                   scene.refused = true;
                   return scene;
                 }});
}

}  // namespace candela::stability

namespace candela {

std::vector<StabilityRecipe> stability_recipes(const std::vector<std::pair<int, int>>& sizes) {
  stability::Recipes all;
  stability::add_depth(all);
  stability::add_worlds(all);
  stability::add_lights(all);
  stability::add_cones_and_crowds(all);
  stability::add_materials(all);
  stability::add_lobes(all);
  stability::add_glass(all);
  stability::add_transparency(all);
  stability::add_textures(all);
  stability::add_geometry(all);
  stability::add_transforms(all);
  stability::add_animation(all);
  stability::add_display(all);
  stability::add_images(all, sizes);
  stability::add_fog(all);
  stability::add_skies(all);
  stability::add_sides(all);
  stability::add_occlusion(all);
  stability::add_far_lights(all);
  stability::add_lobes_under_skies(all);
  stability::add_deep_shadows(all);
  stability::add_bodies_by_faces(all);
  stability::add_mirrors(all);
  stability::add_shutter(all);
  stability::add_metaballs(all);
  stability::add_relief(all);
  stability::add_paths(all);
  stability::add_regions(all);
  return all;
}

}  // namespace candela
