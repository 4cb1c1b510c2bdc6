#include "scene/material_table.h"

#include <limits>
#include <numbers>

#include "scene/blinn_phong.h"

namespace candela {
namespace {

using enum TargetPath;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double least_distance_m = std::numeric_limits<float>::min();

constexpr MaterialProperty properties[] = {
    {material_base_color, "pbrMetallicRoughness/baseColorFactor", 4, 0, 1, [](Material& m) { return &m.base_color.x; },
     Plainest::lambert},
    {material_metallic, "pbrMetallicRoughness/metallicFactor", 1, 0, 1, [](Material& m) { return &m.metallic; },
     Plainest::blinn_phong},
    {material_roughness, "pbrMetallicRoughness/roughnessFactor", 1, 0, 1, [](Material& m) { return &m.roughness; },
     Plainest::blinn_phong},
    {material_emissive, "emissiveFactor", 3, 0, 1, [](Material& m) { return &m.emissive.x; }, Plainest::lambert},
    {material_alpha_cutoff, "alphaCutoff", 1, 0, unbounded, [](Material& m) { return &m.alpha_cutoff; },
     Plainest::lambert},
    {material_normal_scale, "normalTexture/scale", 1, -unbounded, unbounded,
     [](Material& m) { return &m.normal_scale; }, Plainest::lambert},
    {material_occlusion_strength, "occlusionTexture/strength", 1, 0, 1,
     [](Material& m) { return &m.occlusion_strength; }, Plainest::lambert},
    {material_emissive_strength, "extensions/KHR_materials_emissive_strength/emissiveStrength", 1, 0, unbounded,
     [](Material& m) { return &m.emissive_strength; }, Plainest::lambert},
    {material_ior, "extensions/KHR_materials_ior/ior", 1, 0, unbounded, [](Material& m) { return &m.ior; },
     Plainest::blinn_phong},
    {material_specular, "extensions/KHR_materials_specular/specularFactor", 1, 0, 1,
     [](Material& m) { return &m.specular; }, Plainest::blinn_phong},
    {material_specular_color, "extensions/KHR_materials_specular/specularColorFactor", 3, 0, unbounded,
     [](Material& m) { return &m.specular_color.x; }, Plainest::blinn_phong},
    {material_clearcoat, "extensions/KHR_materials_clearcoat/clearcoatFactor", 1, 0, 1,
     [](Material& m) { return &m.clearcoat.factor; }, Plainest::pbr},
    {material_clearcoat_roughness, "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", 1, 0, 1,
     [](Material& m) { return &m.clearcoat.roughness; }, Plainest::pbr},
    {material_clearcoat_normal_scale, "extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", 1, -unbounded,
     unbounded, [](Material& m) { return &m.clearcoat.normal_scale; }, Plainest::pbr},
    {material_sheen_color, "extensions/KHR_materials_sheen/sheenColorFactor", 3, 0, 1,
     [](Material& m) { return &m.sheen.color.x; }, Plainest::pbr},
    {material_sheen_roughness, "extensions/KHR_materials_sheen/sheenRoughnessFactor", 1, 0, 1,
     [](Material& m) { return &m.sheen.roughness; }, Plainest::pbr},
    {material_iridescence, "extensions/KHR_materials_iridescence/iridescenceFactor", 1, 0, 1,
     [](Material& m) { return &m.iridescence.factor; }, Plainest::pbr},
    {material_iridescence_ior, "extensions/KHR_materials_iridescence/iridescenceIor", 1, 1, unbounded,
     [](Material& m) { return &m.iridescence.ior; }, Plainest::pbr},
    {material_iridescence_least, "extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", 1, 0, unbounded,
     [](Material& m) { return &m.iridescence.least_nm; }, Plainest::pbr},
    {material_iridescence_most, "extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", 1, 0, unbounded,
     [](Material& m) { return &m.iridescence.most_nm; }, Plainest::pbr},
    {material_anisotropy, "extensions/KHR_materials_anisotropy/anisotropyStrength", 1, 0, 1,
     [](Material& m) { return &m.anisotropy.strength; }, Plainest::pbr},
    {material_anisotropy_rotation, "extensions/KHR_materials_anisotropy/anisotropyRotation", 1, -unbounded, unbounded,
     [](Material& m) { return &m.anisotropy.rotation_rad; }, Plainest::pbr},
    {material_transmission, "extensions/KHR_materials_transmission/transmissionFactor", 1, 0, 1,
     [](Material& m) { return &m.transmission; }, Plainest::pbr},
    {material_thickness, "extensions/KHR_materials_volume/thicknessFactor", 1, 0, unbounded,
     [](Material& m) { return &m.thickness_m; }, Plainest::pbr},
    {material_attenuation_distance, "extensions/KHR_materials_volume/attenuationDistance", 1, least_distance_m,
     unbounded, [](Material& m) { return &m.attenuation_distance_m; }, Plainest::pbr},
    {material_attenuation_color, "extensions/KHR_materials_volume/attenuationColor", 3, 0, 1,
     [](Material& m) { return &m.attenuation_color.x; }, Plainest::pbr},
    {material_dispersion, "extensions/KHR_materials_dispersion/dispersion", 1, 0, unbounded,
     [](Material& m) { return &m.dispersion; }, Plainest::pbr},
    {material_diffuse_transmission, "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", 1, 0, 1,
     [](Material& m) { return &m.diffuse_transmission.factor; }, Plainest::pbr},
    {material_diffuse_transmission_color,
     "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", 3, 0, unbounded,
     [](Material& m) { return &m.diffuse_transmission.color.x; }, Plainest::pbr},
    {material_multiscatter_color, "extensions/KHR_materials_volume_scatter/multiscatterColorFactor", 3, 0, 1,
     [](Material& m) { return &m.scattering.color.x; }, Plainest::pbr},
    {material_scatter_anisotropy, "extensions/KHR_materials_volume_scatter/scatterAnisotropy", 1, -most_anisotropy,
     most_anisotropy, [](Material& m) { return &m.scattering.anisotropy; }, Plainest::pbr},
    {material_blinn_phong_specular, "extensions/CANDELA_materials_blinn_phong/specularFactor", 3, 0, 1,
     [](Material& m) { return &m.specular_color.x; }, Plainest::blinn_phong},
    {material_blinn_phong_exponent, "extensions/CANDELA_materials_blinn_phong/exponent", 1, 0, most_exponent,
     [](Material& m) { return &m.blinn_phong.exponent; }, Plainest::blinn_phong},
    {material_relief_depth, "extensions/CANDELA_relief/depth", 1, 0, unbounded,
     [](Material& m) { return &m.relief.depth; }, Plainest::lambert},
};

bool lit(const Material& m) { return !m.unlit; }
bool has_clearcoat(const Material& m) { return m.has(Lobe::clearcoat); }
bool has_sheen(const Material& m) { return m.has(Lobe::sheen); }
bool has_iridescence(const Material& m) { return m.has(Lobe::iridescence); }
bool has_anisotropy(const Material& m) { return m.has(Lobe::anisotropy); }
bool has_transmission_lobe(const Material& m) { return m.has(Lobe::transmission); }
bool has_thickness(const Material& m) {
  return (m.has(Lobe::transmission) && m.thickness_m > 0) || m.has(Lobe::scattering);
}
bool has_relief(const Material& m) { return m.has_relief(); }
bool has_diffuse_transmission(const Material& m) { return m.has(Lobe::diffuse_transmission); }

constexpr MaterialTexture textures[] = {
    {TextureSlotName::base_color, "pbrMetallicRoughness/baseColorTexture",
     [](Material& m) -> TextureSlot& { return m.base_color_texture; }, true, [](const Material&) { return true; }},
    {TextureSlotName::orm, "pbrMetallicRoughness/metallicRoughnessTexture",
     [](Material& m) -> TextureSlot& { return m.orm_texture; }, false, lit},
    {TextureSlotName::occlusion, "occlusionTexture", [](Material& m) -> TextureSlot& { return m.occlusion_texture; },
     false, lit},
    {TextureSlotName::normal, "normalTexture", [](Material& m) -> TextureSlot& { return m.normal_texture; }, false,
     lit},
    {TextureSlotName::emissive, "emissiveTexture", [](Material& m) -> TextureSlot& { return m.emissive_texture; }, true,
     lit},
    {TextureSlotName::specular, "extensions/KHR_materials_specular/specularTexture",
     [](Material& m) -> TextureSlot& { return m.specular_texture; }, false, lit},
    {TextureSlotName::specular_color, "extensions/KHR_materials_specular/specularColorTexture",
     [](Material& m) -> TextureSlot& { return m.specular_color_texture; }, true, lit},
    {TextureSlotName::clearcoat, "extensions/KHR_materials_clearcoat/clearcoatTexture",
     [](Material& m) -> TextureSlot& { return m.clearcoat.texture; }, false, has_clearcoat},
    {TextureSlotName::clearcoat_roughness, "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
     [](Material& m) -> TextureSlot& { return m.clearcoat.roughness_texture; }, false, has_clearcoat},
    {TextureSlotName::clearcoat_normal, "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
     [](Material& m) -> TextureSlot& { return m.clearcoat.normal_texture; }, false, has_clearcoat},
    {TextureSlotName::sheen_color, "extensions/KHR_materials_sheen/sheenColorTexture",
     [](Material& m) -> TextureSlot& { return m.sheen.color_texture; }, true, has_sheen},
    {TextureSlotName::sheen_roughness, "extensions/KHR_materials_sheen/sheenRoughnessTexture",
     [](Material& m) -> TextureSlot& { return m.sheen.roughness_texture; }, false, has_sheen},
    {TextureSlotName::iridescence, "extensions/KHR_materials_iridescence/iridescenceTexture",
     [](Material& m) -> TextureSlot& { return m.iridescence.texture; }, false, has_iridescence},
    {TextureSlotName::iridescence_thickness, "extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
     [](Material& m) -> TextureSlot& { return m.iridescence.thickness_texture; }, false, has_iridescence},
    {TextureSlotName::anisotropy, "extensions/KHR_materials_anisotropy/anisotropyTexture",
     [](Material& m) -> TextureSlot& { return m.anisotropy.texture; }, false, has_anisotropy},
    {TextureSlotName::transmission, "extensions/KHR_materials_transmission/transmissionTexture",
     [](Material& m) -> TextureSlot& { return m.transmission_texture; }, false, has_transmission_lobe},
    {TextureSlotName::thickness, "extensions/KHR_materials_volume/thicknessTexture",
     [](Material& m) -> TextureSlot& { return m.thickness_texture; }, false, has_thickness},
    {TextureSlotName::diffuse_transmission, "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
     [](Material& m) -> TextureSlot& { return m.diffuse_transmission.texture; }, false, has_diffuse_transmission},
    {TextureSlotName::diffuse_transmission_color,
     "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
     [](Material& m) -> TextureSlot& { return m.diffuse_transmission.color_texture; }, true, has_diffuse_transmission},
    {TextureSlotName::relief, "extensions/CANDELA_relief/heightTexture",
     [](Material& m) -> TextureSlot& { return m.relief.texture; }, false, has_relief},
};

constexpr bool in_order() {
  for (size_t i = 0; i < std::size(textures); ++i)
    if (size_t(textures[i].slot) != i) return false;
  for (size_t i = 0; i < std::size(properties); ++i)
    if (size_t(properties[i].path) != size_t(material_base_color) + i) return false;
  return true;
}
static_assert(in_order());

}  // namespace

std::string_view MaterialProperty::name() const {
  if (!pointer.starts_with("pbrMetallicRoughness/") && !pointer.starts_with("extensions/")) return pointer;
  const size_t objects = pointer.starts_with("extensions/") ? pointer.find('/', 11) : pointer.find('/');
  return pointer.substr(objects + 1);
}

std::span<const MaterialProperty> material_properties() { return properties; }
const MaterialProperty* material_property(TargetPath path) {
  const size_t i = size_t(path) - size_t(material_base_color);
  return path >= material_base_color && i < std::size(properties) ? &properties[i] : nullptr;
}

std::span<const MaterialTexture> material_textures() { return textures; }
TextureSlot& texture_slot(Material& material, TextureSlotName slot) { return textures[size_t(slot)].at(material); }

}  // namespace candela
