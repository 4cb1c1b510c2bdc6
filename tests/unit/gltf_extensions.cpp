// What the program says of extensions, and which properties an animation may name.
#include <gtest/gtest.h>

#include "gltf/pointers.h"
#include "gltf_builder.h"

namespace candela::test {
namespace {

ExtensionUse use_of(const char* name) {
  GltfBuilder b;
  b.triangle();
  b.use(name);
  const auto scene = b.load();
  EXPECT_TRUE(scene) << scene.error().text();
  return scene ? scene->extensions.at(0) : ExtensionUse{};
}

// Those of the Khronos registry and those being made (July 2026).
TEST(GltfExtensions, OfTheRegistryAreKnown) {
  for (const char* name : {"KHR_accessor_float64",
                           "KHR_animation_pointer",
                           "KHR_audio_graph",
                           "KHR_collision_shapes",
                           "KHR_draco_mesh_compression",
                           "KHR_gaussian_splatting",
                           "KHR_interactivity",
                           "KHR_lights_punctual",
                           "KHR_materials_anisotropy",
                           "KHR_materials_clearcoat",
                           "KHR_materials_diffuse_transmission",
                           "KHR_materials_dispersion",
                           "KHR_materials_emissive_strength",
                           "KHR_materials_ior",
                           "KHR_materials_iridescence",
                           "KHR_materials_pbrSpecularGlossiness",
                           "KHR_materials_sheen",
                           "KHR_materials_specular",
                           "KHR_materials_subsurface",
                           "KHR_materials_transmission",
                           "KHR_materials_unlit",
                           "KHR_materials_variants",
                           "KHR_materials_volume",
                           "KHR_materials_volume_scatter",
                           "KHR_mesh_quantization",
                           "KHR_meshopt_compression",
                           "KHR_node_hoverability",
                           "KHR_node_selectability",
                           "KHR_node_visibility",
                           "KHR_physics_rigid_bodies",
                           "KHR_techniques_webgl",
                           "KHR_texture_basisu",
                           "KHR_texture_procedurals",
                           "KHR_texture_transform",
                           "KHR_texture_video",
                           "KHR_xmp",
                           "KHR_xmp_json_ld",
                           "EXT_lights_ies",
                           "EXT_lights_image_based",
                           "EXT_mesh_gpu_instancing",
                           "EXT_mesh_manifold",
                           "EXT_mesh_primitive_edge_visibility",
                           "EXT_mesh_primitive_restart",
                           "EXT_meshopt_compression",
                           "EXT_texture_astc",
                           "EXT_texture_webp",
                           "MSFT_texture_dds"}) {
    const ExtensionUse use = use_of(name);
    EXPECT_EQ(use.consequence.find("unknown to this program"), std::string::npos) << name;
    EXPECT_EQ(use.consequence.empty(), use.support == Support::supported) << name;
    if (use.support == Support::approximated)
      EXPECT_NE(use.consequence.find("(docs/"), std::string::npos) << name << " names no page of its error";
  }
}

// What Khronos's sample renderer draws (its README).
TEST(GltfExtensions, OfTheSampleRendererAreDrawn) {
  for (const char* name : {"KHR_animation_pointer",
                           "KHR_draco_mesh_compression",
                           "KHR_lights_punctual",
                           "KHR_materials_anisotropy",
                           "KHR_materials_clearcoat",
                           "KHR_materials_diffuse_transmission",
                           "KHR_materials_dispersion",
                           "KHR_materials_emissive_strength",
                           "KHR_materials_ior",
                           "KHR_materials_iridescence",
                           "KHR_materials_pbrSpecularGlossiness",
                           "KHR_materials_sheen",
                           "KHR_materials_specular",
                           "KHR_materials_transmission",
                           "KHR_materials_unlit",
                           "KHR_materials_variants",
                           "KHR_materials_volume",
                           "KHR_materials_volume_scatter",
                           "KHR_mesh_quantization",
                           "KHR_node_visibility",
                           "KHR_texture_basisu",
                           "KHR_texture_transform",
                           "KHR_xmp_json_ld",
                           "EXT_mesh_gpu_instancing",
                           "EXT_texture_webp"})
    EXPECT_NE(use_of(name).support, Support::ignored) << name;
}

// glTF 2.0 Asset Object Model, the properties that may change and that the program draws, by its text and not by the
// reader's tables.
TEST(GltfPointers, ReachThePropertiesOfTheObjectModel) {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", b.accessor<float>("VEC3", {0, 0, 0, 0, 0, 0, 0, 0, 0})}}};
  b.json["meshes"][0]["weights"] = {0.5};
  b.json["materials"] = {{{"name", "all"}}};
  b.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"zfar", 9}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
  b.use("KHR_lights_punctual");
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", Json::object()}}};
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  std::vector<std::string> pointers = {"/nodes/0/translation",
                                       "/nodes/0/rotation",
                                       "/nodes/0/scale",
                                       "/nodes/0/weights",
                                       "/nodes/0/weights/0",
                                       "/nodes/0/extensions/KHR_node_visibility/visible",
                                       "/cameras/0/perspective/aspectRatio",
                                       "/cameras/0/perspective/yfov",
                                       "/cameras/0/perspective/znear",
                                       "/cameras/0/perspective/zfar",
                                       "/cameras/1/orthographic/xmag",
                                       "/cameras/1/orthographic/ymag",
                                       "/cameras/1/orthographic/znear",
                                       "/cameras/1/orthographic/zfar"};
  for (const char* of_light : {"color", "intensity", "range", "spot/innerConeAngle", "spot/outerConeAngle"})
    pointers.push_back(std::string("/extensions/KHR_lights_punctual/lights/0/") + of_light);
  const auto add = [&](const std::string& object, std::initializer_list<const char*> properties,
                       std::initializer_list<const char*> textures) {
    for (const char* property : properties) pointers.push_back("/materials/0/" + object + property);
    for (const char* texture : textures)
      for (const char* part : {"offset", "rotation", "scale"})
        pointers.push_back(fmt::format("/materials/0/{}{}/extensions/KHR_texture_transform/{}", object, texture, part));
  };
  add("", {"alphaCutoff", "emissiveFactor", "normalTexture/scale", "occlusionTexture/strength"},
      {"emissiveTexture", "normalTexture", "occlusionTexture"});
  add("pbrMetallicRoughness/", {"baseColorFactor", "metallicFactor", "roughnessFactor"},
      {"baseColorTexture", "metallicRoughnessTexture"});
  const std::string khr = "extensions/KHR_materials_";
  add(khr + "anisotropy/", {"anisotropyRotation", "anisotropyStrength"}, {"anisotropyTexture"});
  add(khr + "clearcoat/", {"clearcoatFactor", "clearcoatRoughnessFactor", "clearcoatNormalTexture/scale"},
      {"clearcoatNormalTexture", "clearcoatRoughnessTexture", "clearcoatTexture"});
  add(khr + "diffuse_transmission/", {"diffuseTransmissionFactor", "diffuseTransmissionColorFactor"},
      {"diffuseTransmissionTexture", "diffuseTransmissionColorTexture"});
  add(khr + "dispersion/", {"dispersion"}, {});
  add(khr + "emissive_strength/", {"emissiveStrength"}, {});
  add(khr + "ior/", {"ior"}, {});
  add(khr + "iridescence/",
      {"iridescenceFactor", "iridescenceIor", "iridescenceThicknessMinimum", "iridescenceThicknessMaximum"},
      {"iridescenceTexture", "iridescenceThicknessTexture"});
  add(khr + "sheen/", {"sheenColorFactor", "sheenRoughnessFactor"}, {"sheenColorTexture", "sheenRoughnessTexture"});
  add(khr + "specular/", {"specularFactor", "specularColorFactor"}, {"specularTexture", "specularColorTexture"});
  add(khr + "transmission/", {"transmissionFactor"}, {"transmissionTexture"});
  add(khr + "volume/", {"attenuationColor", "attenuationDistance", "thicknessFactor"}, {"thicknessTexture"});
  add(khr + "volume_scatter/", {"multiscatterColorFactor", "multiscatterColor", "scatterAnisotropy"}, {});
  for (const std::string& pointer : pointers) EXPECT_TRUE(gltf::pointer_target(*scene, pointer)) << pointer;
  for (const char* none : {"/materials/1/alphaCutoff", "/materials/0/name", "/nodes/0/translation/3", "/cameras/0"})
    EXPECT_FALSE(gltf::pointer_target(*scene, none)) << none;
}

}  // namespace
}  // namespace candela::test
