#include "gltf/materials.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "gltf/textures.h"
#include "gltf/validate/used_parts.h"
#include "scene/blinn_phong.h"
#include "scene/material_table.h"
#include "scene/shading.h"

namespace candela::gltf {
namespace {

// Factors lie in [0, 1]; a file that breaks this gets the nearest, and a warning.
float factor(Document& document, const Json& object, const char* key, double otherwise, double most,
             const std::string& path) {
  const double value = number(document, object, key, otherwise, path);
  const double used = std::clamp(value, 0.0, most);
  if (used != value)
    document.warn(path + "/" + key, "{} is out of range; {} is used (VALUE_NOT_IN_RANGE)", value, used);
  return float(used);
}

template <class V>
V color_factor(Document& document, const Json& object, const char* key, V otherwise, float most,
               const std::string& path) {
  const V value = vector_of(document, object, key, otherwise, path);
  const V used = glm::clamp(value, V(0), V(most));
  if (used != value) document.warn(path + "/" + key, "a component is out of range and is clamped (VALUE_NOT_IN_RANGE)");
  return used;
}

constexpr float no_limit = std::numeric_limits<float>::max();

struct Importer {
  Document& document;
  const std::set<std::string>& pointers;
  LoadFor use;
  Scene& scene;
  std::vector<bool> image_used;
  std::vector<SceneImage> merged_images;
  std::map<std::pair<int, int>, int> merged_index =
      {};  // occlusion and metallic-roughness image -> index of the merged one
  std::map<std::pair<int, float>, int> roughness_index = {};  // image and glossiness -> index of the image made of them

  bool transform_is_animated(const std::string& texture_path) const {
    const std::string prefix = texture_path + "/extensions/KHR_texture_transform/";
    const auto first = pointers.lower_bound(prefix);
    return first != pointers.end() && first->starts_with(prefix);
  }

  static bool same_sampling(const TextureSlot& a, const TextureSlot& b) {
    return a.sampler == b.sampler && a.uv_set == b.uv_set && a.offset == b.offset && a.scale == b.scale &&
           a.rotation_rad == b.rotation_rad;
  }

  // Occlusion is the red channel and metallic-roughness the other two, so both fit into one texture when they are
  // sampled alike.
  void join_occlusion(const TextureSlot& occlusion, const TextureSlot& metallic_roughness, bool animated,
                      Material& material) {
    material.orm_texture = metallic_roughness;
    material.orm_has_metallic_roughness = bool(metallic_roughness);
    if (!occlusion) return;
    if (!metallic_roughness) {
      material.orm_texture = occlusion;
      material.orm_has_occlusion = true;
      return;
    }
    if (animated || !same_sampling(occlusion, metallic_roughness)) {
      material.occlusion_texture = occlusion;
      return;
    }
    material.orm_has_occlusion = true;
    if (occlusion.image == metallic_roughness.image) return;
    const auto [known, is_new] = merged_index.try_emplace({occlusion.image, metallic_roughness.image},
                                                          int(image_used.size() + merged_images.size()));
    if (is_new) {
      SceneImage merged;
      merged.name = "occlusion, roughness, metallic";
      merged.place =
          document.place(fmt::format("/images/{} and /images/{} merged", occlusion.image, metallic_roughness.image));
      merged.merge_occlusion = occlusion.image;
      merged.merge_metallic_roughness = metallic_roughness.image;
      merged_images.push_back(std::move(merged));
    }
    material.orm_texture.image = known->second;
  }

  TextureSlot slot(const Json& object, const char* key, const std::string& path) {
    return texture_slot(document, object, key, path, image_used);
  }

  void read_extensions(const Json& json, const std::string& path, Material& material) {
    material.unlit = extension(json, "KHR_materials_unlit") != nullptr;
    if (const Json* e = extension(json, "KHR_materials_emissive_strength"))
      material.emissive_strength =
          factor(document, *e, "emissiveStrength", 1, no_limit, path + "/extensions/KHR_materials_emissive_strength");
    if (const Json* e = extension(json, "KHR_materials_ior")) {
      const std::string where = path + "/extensions/KHR_materials_ior";
      const double ior = number(document, *e, "ior", 1.5, where);
      material.ior = ior == 0 || (ior >= 1 && ior <= no_limit) ? float(ior) : 1.5f;
      if (double(material.ior) != double(float(ior)))
        document.warn(where + "/ior", "{} is neither 0 nor at least 1; 1.5 is used (VALUE_NOT_IN_RANGE)", ior);
    }
    if (const Json* e = extension(json, "KHR_materials_specular")) {
      const std::string where = path + "/extensions/KHR_materials_specular";
      material.specular = factor(document, *e, "specularFactor", 1, 1, where);
      material.specular_color = color_factor(document, *e, "specularColorFactor", glm::vec3(1), no_limit, where);
      material.specular_texture = slot(*e, "specularTexture", where);
      material.specular_color_texture = slot(*e, "specularColorTexture", where);
    }
    read_lobes(json, path, material);
    read_scattering(json, path, material);
    read_transmission(json, path, material);
  }

  void read_lobes(const Json& json, const std::string& path, Material& material) {
    if (const Json* e = extension(json, "KHR_materials_clearcoat")) {
      const std::string where = path + "/extensions/KHR_materials_clearcoat";
      Clearcoat& c = material.clearcoat;
      c.factor = factor(document, *e, "clearcoatFactor", 0, 1, where);
      c.roughness = factor(document, *e, "clearcoatRoughnessFactor", 0, 1, where);
      c.texture = slot(*e, "clearcoatTexture", where);
      c.roughness_texture = slot(*e, "clearcoatRoughnessTexture", where);
      c.normal_texture = slot(*e, "clearcoatNormalTexture", where);
      if (const Json* info = member(*e, "clearcoatNormalTexture"))
        c.normal_scale = float(number(document, *info, "scale", 1, where + "/clearcoatNormalTexture"));
    }
    if (const Json* e = extension(json, "KHR_materials_sheen")) {
      const std::string where = path + "/extensions/KHR_materials_sheen";
      Sheen& s = material.sheen;
      s.color = color_factor(document, *e, "sheenColorFactor", glm::vec3(0), 1, where);
      s.roughness = factor(document, *e, "sheenRoughnessFactor", 0, 1, where);
      s.color_texture = slot(*e, "sheenColorTexture", where);
      s.roughness_texture = slot(*e, "sheenRoughnessTexture", where);
    }
    if (const Json* e = extension(json, "KHR_materials_iridescence")) {
      const std::string where = path + "/extensions/KHR_materials_iridescence";
      Iridescence& i = material.iridescence;
      i.factor = factor(document, *e, "iridescenceFactor", 0, 1, where);
      const float ior = factor(document, *e, "iridescenceIor", 1.3, no_limit, where);
      i.ior = std::max(ior, 1.f);
      if (i.ior != ior) document.warn(where + "/iridescenceIor", "{} is below 1; 1 is used (VALUE_NOT_IN_RANGE)", ior);
      i.least_nm = factor(document, *e, "iridescenceThicknessMinimum", 100, no_limit, where);
      i.most_nm = factor(document, *e, "iridescenceThicknessMaximum", 400, no_limit, where);
      i.texture = slot(*e, "iridescenceTexture", where);
      i.thickness_texture = slot(*e, "iridescenceThicknessTexture", where);
    }
    if (const Json* e = extension(json, "KHR_materials_anisotropy")) {
      const std::string where = path + "/extensions/KHR_materials_anisotropy";
      Anisotropy& a = material.anisotropy;
      a.stated = true;
      a.strength = factor(document, *e, "anisotropyStrength", 0, 1, where);
      a.rotation_rad = float(number(document, *e, "anisotropyRotation", 0, where));
      a.texture = slot(*e, "anisotropyTexture", where);
    }
    if (const Json* e = extension(json, "KHR_materials_diffuse_transmission")) {
      const std::string where = path + "/extensions/KHR_materials_diffuse_transmission";
      DiffuseTransmission& d = material.diffuse_transmission;
      d.factor = factor(document, *e, "diffuseTransmissionFactor", 0, 1, where);
      d.color = color_factor(document, *e, "diffuseTransmissionColorFactor", glm::vec3(1), no_limit, where);
      d.texture = slot(*e, "diffuseTransmissionTexture", where);
      d.color_texture = slot(*e, "diffuseTransmissionColorTexture", where);
    }
  }

  // In the terms of metallic-roughness: no metal, a base of the diffuse colour, and a dielectric whose reflectance at
  // normal incidence is the specular colour (the index 0 of KHR_materials_ior stands for 1, KHR_materials_specular
  // scales it). Its energy goes by that extension too: what the strongest channel reflects the base does not get.
  void read_specular_glossiness(const Json& e, const std::string& path, Material& material) {
    const std::string where = path + "/extensions/KHR_materials_pbrSpecularGlossiness";
    material.base_color = color_factor(document, e, "diffuseFactor", glm::vec4(1), 1, where);
    material.base_color_texture = slot(e, "diffuseTexture", where);
    material.metallic = 0;
    material.ior = 0;
    material.specular = 1;
    material.specular_color = color_factor(document, e, "specularFactor", glm::vec3(1), 1, where);
    const float glossiness = factor(document, e, "glossinessFactor", 1, 1, where);
    const TextureSlot both = slot(e, "specularGlossinessTexture", where);
    material.specular_color_texture = both;
    material.specular_texture = {};
    material.orm_texture = {};
    material.orm_has_metallic_roughness = bool(both);
    material.roughness = both ? 1 : 1 - glossiness;
    if (!both) return;
    const auto [known, is_new] =
        roughness_index.try_emplace({both.image, glossiness}, int(image_used.size() + merged_images.size()));
    if (is_new) {
      SceneImage made;
      made.name = "roughness of glossiness";
      made.place = document.place(fmt::format("/images/{}, its glossiness", both.image));
      made.glossiness_of = both.image;
      made.glossiness_factor = glossiness;
      merged_images.push_back(std::move(made));
    }
    material.orm_texture = both;
    material.orm_texture.image = known->second;
  }

  // CANDELA_materials_blinn_phong (docs/understanding/blinn-phong.md). Of the metallic-roughness model the base colour
  // stays: what is diffuse. What reflects at normal incidence is kept as by the extension above.
  void read_blinn_phong(const Json& json, const std::string& path, Material& material) {
    const Json* e = extension(json, "CANDELA_materials_blinn_phong");
    if (!e) return;
    const std::string where = path + "/extensions/CANDELA_materials_blinn_phong";
    material.blinn_phong = {.shades = true, .stated = true};
    material.blinn_phong.exponent = factor(document, *e, "exponent", 32, most_exponent, where);
    material.metallic = 0;
    material.ior = 0;
    material.specular = 1;
    material.specular_color = color_factor(document, *e, "specularFactor", glm::vec3(1), 1, where);
    material.specular_texture = material.specular_color_texture = slot(*e, "specularTexture", where);
    material.orm_has_metallic_roughness = false;
    if (!material.orm_has_occlusion) material.orm_texture = {};
    bool layered = false;
    for (int i = 0; i < lobe_count; ++i) layered |= material.has(Lobe(i));
    if (layered)
      document.warn(where,
                    "lies under no other layer and lets no light through: the material's other extensions are "
                    "left out");
    leave_base(material);
  }

  // CANDELA_relief (docs/understanding/relief.md). Heights are bilinear whatever filter the sampler has.
  void read_relief(const Json& json, const std::string& path, Material& material) {
    const Json* e = extension(json, "CANDELA_relief");
    if (!e) return;
    const std::string where = path + "/extensions/CANDELA_relief";
    const bool opaque = material.alpha_mode == AlphaMode::opaque && material.transmission == 0 &&
                        !extension(json, "KHR_materials_transmission");
    if (!opaque) {
      document.warn(where, "is of opaque materials: one with alpha or transmission is drawn flat");
      return;
    }
    material.relief.depth = factor(document, *e, "depth", 0, no_limit, where);
    material.relief.silhouettes = boolean(document, *e, "silhouettes", true, where);
    material.relief.texture = slot(*e, "heightTexture", where);
    if (!material.relief.texture) return;
    Sampler sampler = scene.samplers[size_t(material.relief.texture.sampler)];
    sampler.mag = sampler.min = sampler.mip = Filter::linear;
    const auto known = std::ranges::find(scene.samplers, sampler);
    material.relief.texture.sampler = int(known - scene.samplers.begin());
    if (known == scene.samplers.end()) scene.samplers.push_back(sampler);
  }

  // Of the draft (KhronosGroup/glTF, pull request 2453), in which the colour's name has changed.
  void read_scattering(const Json& json, const std::string& path, Material& material) {
    const Json* e = extension(json, "KHR_materials_volume_scatter");
    if (!e) return;
    const std::string where = path + "/extensions/KHR_materials_volume_scatter";
    const char* color = e->contains("multiscatterColorFactor") ? "multiscatterColorFactor" : "multiscatterColor";
    Scattering& s = material.scattering;
    s.stated = true;
    s.color = color_factor(document, *e, color, glm::vec3(0), 1, where);
    const float anisotropy = float(number(document, *e, "scatterAnisotropy", 0, where));
    s.anisotropy = std::clamp(anisotropy, -most_anisotropy, most_anisotropy);
    if (s.anisotropy != anisotropy)
      document.warn(where + "/scatterAnisotropy", "{} is not between -1 and 1; {} is used (VALUE_NOT_IN_RANGE)",
                    anisotropy, s.anisotropy);
    if (e->contains("multiscatterColorTexture"))
      document.warn(where + "/multiscatterColorTexture", "is not read: one colour scatters in all of the body");
    const Json* volume = extension(json, "KHR_materials_volume");
    if (!volume || !(number(document, *volume, "thicknessFactor", 0, path) > 0))
      document.warn(where,
                    "the surface bounds no body without KHR_materials_volume and a thicknessFactor above 0; "
                    "nothing is scattered");
    else if (!extension(json, "KHR_materials_transmission") && !extension(json, "KHR_materials_diffuse_transmission"))
      document.warn(where,
                    "no light enters the body without KHR_materials_transmission or "
                    "KHR_materials_diffuse_transmission; nothing is scattered");
  }

  // Ranges are the validation's. A thickness texture is for techniques that have no other way to know how thick a body
  // is.
  void read_transmission(const Json& json, const std::string& path, Material& material) {
    if (const Json* e = extension(json, "KHR_materials_transmission")) {
      const std::string where = path + "/extensions/KHR_materials_transmission";
      material.transmission = factor(document, *e, "transmissionFactor", 0, 1, where);
      material.transmission_texture = slot(*e, "transmissionTexture", where);
    }
    if (const Json* e = extension(json, "KHR_materials_volume")) {
      const std::string where = path + "/extensions/KHR_materials_volume";
      material.thickness_m = factor(document, *e, "thicknessFactor", 0, no_limit, where);
      const bool as_slab = use == LoadFor::raster || (use == LoadFor::direct_tracing && material.scattering.stated);
      if (as_slab) material.thickness_texture = slot(*e, "thicknessTexture", where);
      if (e->contains("attenuationDistance"))
        material.attenuation_distance_m = std::max(factor(document, *e, "attenuationDistance", 1, no_limit, where),
                                                   std::numeric_limits<float>::min());
      material.attenuation_color = color_factor(document, *e, "attenuationColor", glm::vec3(1), 1, where);
    }
    if (const Json* e = extension(json, "KHR_materials_dispersion"))
      material.dispersion =
          factor(document, *e, "dispersion", 0, no_limit, path + "/extensions/KHR_materials_dispersion");
  }

  Material read(const Json& json, const std::string& path) {
    Material material;
    material.name = text(document, json, "name", "", path);
    TextureSlot metallic_roughness;
    const Json* gloss = extension(json, "KHR_materials_pbrSpecularGlossiness");
    if (const Json* pbr = gloss ? nullptr : member(json, "pbrMetallicRoughness")) {
      const std::string where = path + "/pbrMetallicRoughness";
      material.base_color = color_factor(document, *pbr, "baseColorFactor", glm::vec4(1), 1, where);
      material.metallic = factor(document, *pbr, "metallicFactor", 1, 1, where);
      material.roughness = factor(document, *pbr, "roughnessFactor", 1, 1, where);
      material.base_color_texture = slot(*pbr, "baseColorTexture", where);
      metallic_roughness = slot(*pbr, "metallicRoughnessTexture", where);
    }
    material.normal_texture = slot(json, "normalTexture", path);
    if (const Json* info = member(json, "normalTexture"))
      material.normal_scale = float(number(document, *info, "scale", 1, path + "/normalTexture"));
    const TextureSlot occlusion = slot(json, "occlusionTexture", path);
    if (const Json* info = member(json, "occlusionTexture"))
      material.occlusion_strength = factor(document, *info, "strength", 1, 1, path + "/occlusionTexture");
    join_occlusion(occlusion, metallic_roughness,
                   transform_is_animated(path + "/occlusionTexture") ||
                       transform_is_animated(path + "/pbrMetallicRoughness/metallicRoughnessTexture"),
                   material);
    material.emissive_texture = slot(json, "emissiveTexture", path);
    material.emissive = color_factor(document, json, "emissiveFactor", glm::vec3(0), 1, path);
    const std::string mode = text(document, json, "alphaMode", "OPAQUE", path);
    material.alpha_mode = mode == "MASK" ? AlphaMode::mask : mode == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
    if (mode != "MASK" && mode != "BLEND" && mode != "OPAQUE")
      document.warn(path + "/alphaMode", "'{}' is no alpha mode; OPAQUE is used (VALUE_NOT_IN_LIST)", mode);
    material.alpha_cutoff = factor(document, json, "alphaCutoff", 0.5, no_limit, path);
    material.double_sided = boolean(document, json, "doubleSided", false, path);
    read_extensions(json, path, material);
    if (gloss) {
      if (material.orm_has_occlusion) material.occlusion_texture = material.orm_texture;
      material.orm_has_occlusion = false;
      read_specular_glossiness(*gloss, path, material);
    }
    read_blinn_phong(json, path, material);
    read_relief(json, path, material);
    return material;
  }
};

}  // namespace

namespace {

// Surfaces have room for two sets of texture coordinates, which may be any two of the file. Textures of a third are
// left out.
void choose_uv_sets(Document& document, int index, Material& material) {
  std::vector<int> sets;
  const auto each_slot = [&](const std::function<void(TextureSlot&)>& f) {
    for (int k = 0; k <= int(TextureSlotName::relief); ++k)
      if (TextureSlot& slot = texture_slot(material, TextureSlotName(k))) f(slot);
  };
  each_slot([&](const TextureSlot& slot) {
    if (std::ranges::find(sets, slot.uv_set) == sets.end()) sets.push_back(slot.uv_set);
  });
  std::ranges::sort(sets);
  if (sets.empty() || sets.back() <= 1) return;
  const std::array<int, 2> chosen = {sets[0], sets.size() > 1 ? sets[1] : sets[0] == 0 ? 1 : 0};
  document.uv_sets[index] = chosen;
  each_slot([&](TextureSlot& slot) {
    if (slot.uv_set == chosen[0] || slot.uv_set == chosen[1]) {
      slot.uv_set = slot.uv_set == chosen[0] ? 0 : 1;
      return;
    }
    document.warn(fmt::format("/materials/{}", index),
                  "a texture of TEXCOORD_{} is left out: the material uses {} sets, and two are read", slot.uv_set,
                  sets.size());
    slot = TextureSlot{};
  });
}

}  // namespace

void import_materials(Document& document, const std::set<std::string>& pointers, LoadFor use, Scene& scene) {
  import_samplers(document, scene);
  const Json* images = member(document.json, "images");
  Importer importer{document, pointers, use, scene, std::vector<bool>(images ? images->size() : 0), {}};
  std::optional<UsedParts> used;  // found where it is asked
  // What cannot be read is the default material where no surface shows it.
  const auto read = [&](const Json& json, const std::string& path) -> Material {
    try {
      return importer.read(json, path);
    } catch (const Failure& failure) {
      if (!used) used.emplace(document.json, false);
      if (used->uses(path)) throw;
      document.warn(path, "{}; the scene does not use it", failure.error.message);
      return {};
    }
  };
  if (const Json* materials = member(document.json, "materials")) {
    scene.materials.reserve(materials->size());
    for (size_t i = 0; i < materials->size(); ++i) {
      scene.materials.push_back(read((*materials)[i], fmt::format("/materials/{}", i)));
      choose_uv_sets(document, int(i), scene.materials.back());
    }
  }
  import_images(document, importer.image_used, scene);
  for (SceneImage& merged : importer.merged_images) scene.images.push_back(std::move(merged));
  check_transfer(document, scene);
}

}  // namespace candela::gltf
