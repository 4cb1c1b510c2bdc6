#include <gtest/gtest.h>

#include "base/files.h"
#include "gltf_builder.h"
#include "scene/scene_images.h"

namespace candela::test::gltf_materials {
namespace {

// Three images, three textures (the second with a sampler), one material that the caller fills.
GltfBuilder textured(const Json& material) {
  GltfBuilder b;
  b.triangle();
  for (const char* name :
       {"KHR_texture_transform", "KHR_materials_specular", "KHR_materials_ior", "KHR_materials_emissive_strength"})
    b.use(name);
  for (int i = 0; i < 3; ++i) b.json["images"].push_back({{"uri", png_uri()}, {"name", fmt::format("image {}", i)}});
  b.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9728}},
                        {{"minFilter", 9985}}};
  b.json["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}, {{"source", 2}}};
  b.json["materials"] = {material};
  return b;
}

TEST(GltfMaterials, DefaultsAndFactors) {
  Expected<Scene> scene = textured(Json::object()).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material defaults;
  EXPECT_EQ(scene->materials[0].base_color, defaults.base_color);
  EXPECT_EQ(scene->materials[0].metallic, 1);
  EXPECT_EQ(scene->materials[0].ior, 1.5f);
  scene = textured({{"alphaMode", "MASK"}}).load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->materials[0].alpha_cutoff, 0.5f);
  scene =
      textured(
          {{"pbrMetallicRoughness",
            {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.75}}},
           {"emissiveFactor", {1, 0.5, 0}},
           {"alphaMode", "MASK"},
           {"alphaCutoff", 0.125},
           {"doubleSided", true},
           {"extensions",
            {{"KHR_materials_ior", {{"ior", 1.25}}},
             {"KHR_materials_specular",
              {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 0}}, {"specularColorTexture", {{"index", 2}}}}},
             {"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}})
          .load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material& m = scene->materials[0];
  EXPECT_EQ(m.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.25f);
  EXPECT_EQ(m.roughness, 0.75f);
  EXPECT_EQ(m.emissive, glm::vec3(1, 0.5, 0));
  EXPECT_EQ(m.emissive_strength, 20);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.125f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, glm::vec3(2, 1, 0));
  EXPECT_EQ(m.specular_color_texture.image, 2);
}

TEST(GltfMaterials, TransformsSamplersAndOnlyUsedImages) {
  const Expected<Scene> scene =
      textured({{"pbrMetallicRoughness",
                 {{"baseColorTexture",
                   {{"index", 1},
                    {"texCoord", 0},
                    {"extensions",
                     {{"KHR_texture_transform",
                       {{"offset", {0.5, 0.25}}, {"rotation", 1.5}, {"scale", {2, 3}}, {"texCoord", 1}}}}}}}}}})
          .load();
  ASSERT_TRUE(scene) << scene.error().text();
  const TextureSlot& slot = scene->materials[0].base_color_texture;
  EXPECT_EQ(slot.image, 1);
  EXPECT_EQ(slot.uv_set, 1);
  EXPECT_EQ(slot.offset, glm::vec2(0.5, 0.25));
  EXPECT_EQ(slot.scale, glm::vec2(2, 3));
  EXPECT_EQ(slot.rotation_rad, 1.5f);
  const Sampler& sampler = scene->samplers.at(size_t(slot.sampler));
  EXPECT_EQ(sampler.wrap_u, Wrap::clamp);
  EXPECT_EQ(sampler.wrap_v, Wrap::mirror);
  EXPECT_EQ(sampler.mag, Filter::nearest);
  EXPECT_FALSE(sampler.mipmaps);
  EXPECT_EQ(scene->samplers[0], Sampler());
  EXPECT_EQ(scene->samplers[2].mip, Filter::nearest);
  EXPECT_EQ(scene->samplers[2].min, Filter::linear);
  EXPECT_FALSE(scene->images[1].encoded.empty());
  EXPECT_TRUE(scene->images[0].encoded.empty()) << "no material uses it";
  EXPECT_EQ(scene->images[1].place, "test.glb: /images/1 'image 1'");
}

Json orm_material(const Json& occlusion, const Json& metallic_roughness) {
  Json material = Json::object();
  if (!occlusion.is_null()) material["occlusionTexture"] = occlusion;
  if (!metallic_roughness.is_null()) material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = metallic_roughness;
  return material;
}

TEST(GltfMaterials, OcclusionJoinsMetallicRoughnessWhereItCan) {
  const Json first = {{"index", 0}}, third = {{"index", 2}}, sampled = {{"index", 1}};
  Expected<Scene> scene = textured(orm_material(first, third)).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material* m = &scene->materials[0];
  EXPECT_TRUE(m->orm_has_occlusion && m->orm_has_metallic_roughness);
  ASSERT_EQ(m->orm_texture.image, 3) << "a new image behind the file's three";
  EXPECT_EQ(scene->images[3].merge_occlusion, 0);
  EXPECT_EQ(scene->images[3].merge_metallic_roughness, 2);
  EXPECT_FALSE(bool(m->occlusion_texture));

  scene = textured(orm_material(first, first)).load();
  m = &scene->materials[0];
  EXPECT_EQ(m->orm_texture.image, 0);
  EXPECT_TRUE(m->orm_has_occlusion && m->orm_has_metallic_roughness);
  EXPECT_EQ(scene->images.size(), 3u);

  for (const Json& other : {sampled, Json({{"index", 0}, {"texCoord", 1}})}) {
    scene = textured(orm_material(other, third)).load();
    m = &scene->materials[0];
    EXPECT_EQ(m->orm_texture.image, 2);
    EXPECT_FALSE(m->orm_has_occlusion);
    EXPECT_TRUE(bool(m->occlusion_texture)) << "sampled differently: kept apart";
  }
  scene = textured(orm_material(first, nullptr)).load();
  m = &scene->materials[0];
  EXPECT_EQ(m->orm_texture.image, 0);
  EXPECT_TRUE(m->orm_has_occlusion);
  EXPECT_FALSE(m->orm_has_metallic_roughness);
}

TEST(GltfMaterials, MaterialsShareAMergedImage) {
  GltfBuilder b = textured(orm_material({{"index", 0}}, {{"index", 2}}));
  b.json["materials"].push_back(b.json["materials"][0]);
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->images.size(), 4u);
  EXPECT_EQ(scene->materials[0].orm_texture.image, scene->materials[1].orm_texture.image);
}

TEST(GltfMaterials, TexturesInOtherFormatsFallBackOrAreLeftOut) {
  GltfBuilder b = textured({{"emissiveTexture", {{"index", 0}}}, {"normalTexture", {{"index", 1}}}});
  b.use("MSFT_texture_dds");
  b.json["textures"][0] = {{"extensions", {{"MSFT_texture_dds", {{"source", 2}}}}}};
  b.json["textures"][1]["extensions"]["MSFT_texture_dds"]["source"] = 2;
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_FALSE(bool(scene->materials[0].emissive_texture));
  EXPECT_EQ(scene->materials[0].normal_texture.image, 1);
  EXPECT_TRUE(mentions(scene->warnings, "/materials/0/emissiveTexture"));
}

// The image of an extension that is read goes before `source`; without one `source` is shown. WebP loses less than
// Basis Universal.
TEST(GltfMaterials, TexturesShowTheImagesOfTheirExtensions) {
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"}) {
    GltfBuilder b = textured({{"emissiveTexture", {{"index", 0}}}, {"normalTexture", {{"index", 1}}}});
    b.use(name, true);
    b.json["textures"][0] = {{"extensions", {{name, {{"source", 2}}}}}};
    b.json["textures"][1]["extensions"][name] = Json::object();
    auto scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(scene->materials[0].emissive_texture.image, 2);
    EXPECT_EQ(scene->materials[0].normal_texture.image, 1);
    b.json["textures"][0]["source"] = 0;
    b.json["textures"][1]["extensions"] = {{"KHR_texture_basisu", {{"source", 0}}},
                                           {"EXT_texture_webp", {{"source", 2}}}};
    scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(scene->materials[0].emissive_texture.image, 2);
    EXPECT_EQ(scene->materials[0].normal_texture.image, 2);
    b.json["textures"][0]["extensions"][name]["source"] = 9;
    scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_TRUE(mentions(scene->warnings, "source: unresolved reference: 9"));
  }
}

std::vector<std::byte> stored_image(const std::string& name) {
  return *read_file(std::filesystem::path(CANDELA_SOURCE_DIR) / "tests/images" / name);
}

// Base colours are sRGB, normals are not: the use of a texture decides, and a KTX2 file that says otherwise is named.
TEST(GltfMaterials, ColoursThatAFileCallsOtherwiseAreNamed) {
  for (const bool colour : {true, false})
    for (const int says : {1, 2}) {
      GltfBuilder b = textured({{"normalTexture", {{"index", 1}}}});
      if (colour) b.json["materials"][0] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}};
      std::vector<std::byte> file = stored_image("uastc_modes.ktx2");
      uint32_t format_at = 0;
      std::memcpy(&format_at, file.data() + 48, 4);
      file[format_at + 4 + 10] = std::byte(says);
      b.json["images"][2] = {{"name", "paint"}, {"mimeType", "image/ktx2"}, {"bufferView", b.view(file)}};
      b.use("KHR_texture_basisu");
      b.json["textures"][1] = {{"extensions", {{"KHR_texture_basisu", {{"source", 2}}}}}};
      const auto scene = b.load();
      ASSERT_TRUE(scene) << scene.error().text();
      EXPECT_EQ(mentions(scene->warnings, "/images/2 'paint': the file says"), colour == (says == 1)) << colour << says;
      EXPECT_TRUE(decode_scene_image(*scene, 2)->warnings.empty());
    }
}

TEST(GltfMaterials, MergedImagesDecodeToTheirChannels) {
  // A 2x1 greyscale PNG (0, 255) as occlusion and a 1x1 RGB PNG (10, 20, 30) as metallic-roughness.
  const std::string wide =
      "data:image/"
      "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAAAAADRSSBWAAAAC0lEQVR42mNg+A8AAQIBANEay48AAAAASUVORK5CYII=";
  const std::string small =
      "data:image/"
      "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mPgEpEDAABoAD1q9XBbAAAAAElFTkSuQmCC";
  GltfBuilder b = textured(orm_material({{"index", 0}}, {{"index", 2}}));
  b.json["images"][0]["uri"] = wide;
  b.json["images"][2]["uri"] = small;
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Expected<SceneTexture> texture = decode_scene_image(*scene, 3);
  ASSERT_TRUE(texture) << texture.error().text();
  EXPECT_TRUE(texture->warnings.empty());
  const DecodedImage* image = &texture->image;
  ASSERT_EQ(image->width, 2);
  ASSERT_EQ(image->height, 1);
  ASSERT_EQ(image->format, DecodedImage::Format::rgba8);
  const std::vector<int> wanted = {0, 20, 30, 255, 255, 20, 30, 255};
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(std::to_integer<int>(image->pixels[i]), wanted[i]) << i;
}

}  // namespace
}  // namespace candela::test::gltf_materials
