// Lobes of Khronos materials at the ends of what their extensions allow.
#include "stability/stage.h"

namespace candela::stability {
namespace {

json with_lobes(json material, const json& lobes) {
  for (const auto& [name, values] : lobes.items()) material["extensions"]["KHR_materials_" + name] = values;
  return material;
}

// A ball over the room's floor, near the light, which also shines from behind.
void add_ball(Recipes& all, std::string name, std::string what, double metallic, double roughness, json lobes,
              double bound = 1e-3) {
  all.push_back({"materials", std::move(name), std::move(what), [=](StabilityInput& in) {
                   GlbWriter out;
                   lit_room(out, in.rng);
                   for (const auto& [lobe, values] : lobes.items()) out.use_extension("KHR_materials_" + lobe);
                   place(out, with_tangents(sphere(0.6, 64, 48)),
                         with_lobes(lit({0.5, 0.4, 0.3}, metallic, roughness), lobes), {0, 0.75, 1.5});
                   point(out, {0, 1, 0.5}, 10);
                   StabilityScene scene = scene_of(out);
                   scene.bound = bound;
                   scene.paths = true;
                   return scene;
                 }});
}

json film(double ior, double thickness_nm) {
  return {{"iridescence",
           {{"iridescenceFactor", 1}, {"iridescenceIor", ior}, {"iridescenceThicknessMaximum", thickness_nm}}}};
}
json coat(double roughness) {
  return {{"clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", roughness}}}};
}
json sheen(double roughness) {
  return {{"sheen", {{"sheenColorFactor", {1, 1, 1}}, {"sheenRoughnessFactor", roughness}}}};
}
json stretched(double rotation) {
  return {{"anisotropy", {{"anisotropyStrength", 1}, {"anisotropyRotation", rotation}}}};
}
json passing(double red) {
  return {
      {"diffuse_transmission", {{"diffuseTransmissionFactor", 1}, {"diffuseTransmissionColorFactor", {red, 1, 0}}}}};
}
json all_of(std::initializer_list<json> lobes) {
  json all;
  for (const json& lobe : lobes) all.update(lobe);
  return all;
}

}  // namespace

void add_lobes(Recipes& all) {
  add_ball(all, "coat of roughness 0", "a mirror over a rough base", 0, 1, coat(0));
  add_ball(all, "coat of roughness 1", "over a mirror", 1, 0, coat(1));
  add_ball(all, "sheen of roughness 0", "straight fibres: grazing light above what comes in, held at 1", 0, 1,
           sheen(0));
  add_ball(all, "sheen of roughness 1", "white, over a metal", 1, 0.5, sheen(1));
  add_ball(all, "film of 0 nm", "as without one", 0.5, 0.3, film(1.8, 0));
  add_ball(all, "film of 1e9 nm", "washed out", 0.5, 0.3, film(1.8, 1e9));
  add_ball(all, "film of 1e38 nm", "its path is no float", 0.5, 0.3, film(1.8, 1e38));
  add_ball(all, "film of ior 1", "there is no interface to air", 1, 0.3, film(1, 400));
  add_ball(all, "film of ior 1e6", "a mirror", 0, 0.3, film(1e6, 400));
  add_ball(all, "stretched mirror", "anisotropy 1, roughness 0: 0.002 across and 1 along", 1, 0, stretched(0));
  add_ball(all, "stretched, turned by 1e6 rad", "", 1, 0.5, stretched(1e6));
  add_ball(all, "passing all light", "colour of 1e6 in one channel", 0, 0.5, passing(1e6));
  add_ball(all, "all lobes", "each at its end", 0.5, 0,
           all_of({coat(0), sheen(0), film(1e6, 1e9), stretched(3), passing(1)}));
}

}  // namespace candela::stability
