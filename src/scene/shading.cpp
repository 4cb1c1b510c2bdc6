#include "scene/shading.h"

#include "scene/material_table.h"

namespace candela {
namespace {

void make_lambert(Material& m) {
  if (m.unlit) return;
  m.metallic = 0, m.roughness = 1;
  m.specular = 0;  // KHR_materials_specular: neither f0 nor f90 is left
  m.specular_texture = {}, m.specular_color_texture = {};
  m.transmission = 0, m.transmission_texture = {};
  m.thickness_m = 0, m.thickness_texture = {}, m.dispersion = 0;
  m.clearcoat = {}, m.sheen = {}, m.iridescence = {}, m.anisotropy = {}, m.diffuse_transmission = {};
  m.orm_has_metallic_roughness = false;
  if (!m.orm_has_occlusion) m.orm_texture = {};
}

bool is_of_gloss(TargetPath path) {
  const MaterialProperty* property = material_property(path);
  return property && !property->lambert;
}

}  // namespace

const std::vector<ShadingName>& shadings() {
  static const std::vector<ShadingName> all = {
      {"pbr", "materials as the file has them"},
      {"lambert", "the base colour alone, reflected alike in all directions: no metal, no gloss"}};
  return all;
}

void apply_shading(Scene& scene, const std::string& name) {
  if (name != "lambert") return;
  for (Material& m : scene.materials) make_lambert(m);
  make_lambert(scene.default_material);
  for (Animation& animation : scene.animations)
    std::erase_if(animation.channels, [](const AnimationChannel& c) { return is_of_gloss(c.path); });
}

}  // namespace candela
