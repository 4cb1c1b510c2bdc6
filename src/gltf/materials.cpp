#include "gltf/materials.h"

#include "gltf/textures.h"

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
    read_transmission(json, path, material);
  }

  // Ranges are the validation's. A thickness texture is for techniques that have no other way to know how thick a body
  // is.
  void read_transmission(const Json& json, const std::string& path, Material& material) {
    if (const Json* e = extension(json, "KHR_materials_transmission")) {
      const std::string where = path + "/extensions/KHR_materials_transmission";
      material.transmission = factor(document, *e, "transmissionFactor", 0, 1, where);
      if (use == LoadFor::path_tracing) material.transmission_texture = slot(*e, "transmissionTexture", where);
    }
    if (const Json* e = extension(json, "KHR_materials_volume")) {
      const std::string where = path + "/extensions/KHR_materials_volume";
      material.thickness_m = factor(document, *e, "thicknessFactor", 0, no_limit, where);
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
    if (const Json* pbr = member(json, "pbrMetallicRoughness")) {
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
    return material;
  }
};

}  // namespace

void import_materials(Document& document, const std::set<std::string>& pointers, LoadFor use, Scene& scene) {
  import_samplers(document, scene);
  const Json* images = member(document.json, "images");
  Importer importer{document, pointers, use, scene, std::vector<bool>(images ? images->size() : 0), {}};
  if (const Json* materials = member(document.json, "materials"))
    for (size_t i = 0; i < materials->size(); ++i)
      scene.materials.push_back(importer.read((*materials)[i], fmt::format("/materials/{}", i)));
  import_images(document, importer.image_used, scene);
  for (SceneImage& merged : importer.merged_images) scene.images.push_back(std::move(merged));
}

}  // namespace candela::gltf
