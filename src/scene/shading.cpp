#include "scene/shading.h"

#include "scene/material_table.h"

namespace candela {
namespace {

void make_lambert(Material& m) {
  if (m.unlit) return;
  m.metallic = 0, m.roughness = 1;
  m.specular = 0;  // KHR_materials_specular: neither f0 nor f90 is left
  m.specular_texture = {}, m.specular_color_texture = {};
  m.blinn_phong = {};
  leave_base(m);
  m.orm_has_metallic_roughness = false;
  if (!m.orm_has_occlusion) m.orm_texture = {};
}

void make_blinn_phong(Material& m) {
  if (m.unlit) return;
  m.blinn_phong.shades = true;
  leave_base(m);
}

}  // namespace

void leave_base(Material& m) {
  m.transmission = 0, m.transmission_texture = {};
  m.thickness_m = 0, m.thickness_texture = {}, m.dispersion = 0;
  m.clearcoat = {}, m.sheen = {}, m.iridescence = {}, m.anisotropy = {}, m.diffuse_transmission = {};
  m.scattering = {};
}

const std::vector<ShadingName>& shadings() {
  static const std::vector<ShadingName> all = {
      {"pbr", "materials as the file has them"},
      {"blinn-phong", "the base with Blinn's lobe of the exponent that goes with the roughness instead of facets"},
      {"lambert", "the base colour alone, reflected alike in all directions: no metal, no gloss"}};
  return all;
}

void apply_shading(Scene& scene, const std::string& name) {
  if (name == "pbr") return;
  const bool lambert = name == "lambert";
  const auto make = lambert ? make_lambert : make_blinn_phong;
  for (Material& m : scene.materials) make(m);
  make(scene.default_material);
  const Plainest most = lambert ? Plainest::lambert : Plainest::blinn_phong;
  for (Animation& animation : scene.animations)
    std::erase_if(animation.channels, [&](const AnimationChannel& c) {
      const MaterialProperty* property = material_property(c.path);
      return property && property->plainest > most;
    });
}

}  // namespace candela
