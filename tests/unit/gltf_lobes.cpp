// Clear coat, sheen, iridescence, anisotropy, diffuse transmission and specular-glossiness: what is read, what is
// clamped, and that every factor and texture of a material can be animated.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/material_table.h"
#include "scene/pose.h"
#include "scene/scene_images.h"
#include "scene/texture_slots.h"

namespace candela::test {
namespace {

// A triangle with UVs whose one material has these extensions; texture i shows image i.
GltfBuilder with_extensions(const Json& extensions, int images = 0) {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
  for (const auto& [name, unused] : extensions.items()) b.use(name.c_str());
  for (int i = 0; i < images; ++i) {
    b.json["images"].push_back({{"uri", png_uri()}});
    b.json["textures"].push_back({{"source", i}});
  }
  b.json["materials"] = {{{"extensions", extensions}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  return b;
}

TEST(GltfLobes, AreReadWithTheirTextures) {
  const auto scene =
      with_extensions(
          {{"KHR_materials_clearcoat",
            {{"clearcoatFactor", 0.5},
             {"clearcoatRoughnessFactor", 0.25},
             {"clearcoatTexture", {{"index", 0}}},
             {"clearcoatRoughnessTexture", {{"index", 1}}},
             {"clearcoatNormalTexture", {{"index", 2}, {"scale", 0.75}}}}},
           {"KHR_materials_sheen",
            {{"sheenColorFactor", {0.1, 0.2, 0.3}},
             {"sheenRoughnessFactor", 0.4},
             {"sheenColorTexture", {{"index", 0}}}}},
           {"KHR_materials_iridescence",
            {{"iridescenceFactor", 0.9},
             {"iridescenceIor", 1.7},
             {"iridescenceThicknessMinimum", 200},
             {"iridescenceThicknessMaximum", 800},
             {"iridescenceThicknessTexture", {{"index", 1}}}}},
           {"KHR_materials_anisotropy",
            {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 1.5}, {"anisotropyTexture", {{"index", 2}}}}},
           {"KHR_materials_diffuse_transmission",
            {{"diffuseTransmissionFactor", 0.3}, {"diffuseTransmissionColorFactor", {0.5, 1, 0.25}}}}},
          3)
          .load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material& m = scene->materials[0];
  EXPECT_EQ(m.clearcoat.factor, 0.5f);
  EXPECT_EQ(m.clearcoat.roughness, 0.25f);
  EXPECT_EQ(m.clearcoat.texture.image, 0);
  EXPECT_EQ(m.clearcoat.roughness_texture.image, 1);
  EXPECT_EQ(m.clearcoat.normal_texture.image, 2);
  EXPECT_EQ(m.clearcoat.normal_scale, 0.75f);
  EXPECT_EQ(m.sheen.color, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.sheen.roughness, 0.4f);
  EXPECT_EQ(m.sheen.color_texture.image, 0);
  EXPECT_EQ(m.iridescence.factor, 0.9f);
  EXPECT_EQ(m.iridescence.ior, 1.7f);
  EXPECT_EQ(m.iridescence.least_nm, 200);
  EXPECT_EQ(m.iridescence.most_nm, 800);
  EXPECT_EQ(m.iridescence.thickness_texture.image, 1);
  EXPECT_EQ(m.anisotropy.strength, 0.6f);
  EXPECT_EQ(m.anisotropy.rotation_rad, 1.5f);
  EXPECT_EQ(m.anisotropy.texture.image, 2);
  EXPECT_EQ(m.diffuse_transmission.factor, 0.3f);
  EXPECT_EQ(m.diffuse_transmission.color, glm::vec3(0.5f, 1, 0.25f));
  for (const Lobe lobe :
       {Lobe::clearcoat, Lobe::sheen, Lobe::iridescence, Lobe::anisotropy, Lobe::diffuse_transmission})
    EXPECT_TRUE(m.has(lobe)) << int(lobe);
  EXPECT_FALSE(m.has(Lobe::transmission));
  EXPECT_FALSE(scene->meshes[0].sections[0].tangent.empty()) << "made for the clear coat's normal texture";
}

TEST(GltfLobes, AreSupported) {
  Json extensions;
  for (const char* name : {"clearcoat", "sheen", "iridescence", "anisotropy", "diffuse_transmission"})
    extensions[std::string("KHR_materials_") + name] = Json::object();
  GltfBuilder b = with_extensions(extensions);
  b.json["extensionsRequired"] = {"KHR_materials_sheen"};
  for (const LoadFor use : {LoadFor::raster, LoadFor::path_tracing}) {
    const auto scene = b.load(use);
    ASSERT_TRUE(scene) << scene.error().text();
    ASSERT_EQ(scene->extensions.size(), 5u);
    for (const ExtensionUse& e : scene->extensions) {
      EXPECT_EQ(e.support, Support::supported) << e.name;
      EXPECT_EQ(e.consequence, "") << e.name;
    }
  }
}

TEST(GltfLobes, DefaultsShowNothing) {
  Json extensions;
  for (const char* name : {"clearcoat", "sheen", "iridescence", "anisotropy", "diffuse_transmission"})
    extensions[std::string("KHR_materials_") + name] = Json::object();
  const auto scene = with_extensions(extensions).load();
  ASSERT_TRUE(scene) << scene.error().text();
  for (int lobe = 0; lobe < lobe_count; ++lobe) EXPECT_FALSE(scene->materials[0].has(Lobe(lobe))) << lobe;
  EXPECT_EQ(scene->materials[0].iridescence.ior, 1.3f);
  EXPECT_EQ(scene->materials[0].iridescence.least_nm, 100);
  EXPECT_EQ(scene->materials[0].iridescence.most_nm, 400);
}

TEST(GltfLobes, ValuesOutOfRangeAreClampedWithAWarning) {
  const auto scene = with_extensions({{"KHR_materials_clearcoat", {{"clearcoatFactor", 2}}},
                                      {"KHR_materials_iridescence", {{"iridescenceIor", 0.5}}},
                                      {"KHR_materials_sheen", {{"sheenColorFactor", {-1, 0, 3}}}}})
                         .load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->materials[0].clearcoat.factor, 1);
  EXPECT_EQ(scene->materials[0].iridescence.ior, 1);
  EXPECT_EQ(scene->materials[0].sheen.color, glm::vec3(0, 0, 1));
  for (const char* place : {"clearcoatFactor", "iridescenceIor", "sheenColorFactor"})
    EXPECT_TRUE(mentions(scene->warnings, place)) << place;
}

TEST(GltfLobes, SpecularGlossinessBecomesADielectricOfItsColour) {
  GltfBuilder b = with_extensions(
      {{"KHR_materials_pbrSpecularGlossiness",
        {{"diffuseFactor", {0.2, 0.4, 0.6, 0.5}}, {"specularFactor", {0.9, 0.5, 0.1}}, {"glossinessFactor", 0.75}}}});
  const auto plain = b.load();
  ASSERT_TRUE(plain) << plain.error().text();
  const Material& m = plain->materials[0];
  EXPECT_EQ(m.base_color, glm::vec4(0.2f, 0.4f, 0.6f, 0.5f));
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.ior, 0) << "a reflectance of 1, scaled by the colour";
  EXPECT_EQ(m.specular_color, glm::vec3(0.9f, 0.5f, 0.1f));

  b = with_extensions({{"KHR_materials_pbrSpecularGlossiness",
                        {{"glossinessFactor", 0.5}, {"specularGlossinessTexture", {{"index", 0}}}}}},
                      1);
  const auto textured = b.load();
  ASSERT_TRUE(textured) << textured.error().text();
  const Material& t = textured->materials[0];
  EXPECT_EQ(t.specular_color_texture.image, 0);
  EXPECT_TRUE(t.orm_has_metallic_roughness);
  EXPECT_FALSE(t.orm_has_occlusion);
  EXPECT_EQ(t.roughness, 1);
  const auto source = decode_scene_image(*textured, 0), made = decode_scene_image(*textured, t.orm_texture.image);
  ASSERT_TRUE(source && made);
  ASSERT_EQ(made->image.format, DecodedImage::Format::rgba8);
  const int alpha = std::to_integer<int>(source->image.pixels[3]);
  EXPECT_EQ(std::to_integer<int>(made->image.pixels[1]), int(std::lround((1 - 0.5 * alpha / 255.0) * 255)));
  EXPECT_EQ(std::to_integer<int>(made->image.pixels[2]), 0);
}

// Each row of the two tables is reached by its pointer, and changes what it says.
TEST(GltfLobes, EveryFactorAndTextureIsReachedByPointers) {
  for (const MaterialProperty& p : material_properties()) {
    GltfBuilder b = with_extensions(Json::object());
    b.use("KHR_animation_pointer");
    const std::vector<float> value(size_t(p.components), 0.9f);
    const int times = b.accessor<float>("SCALAR", {0}), values = p.components == 1 ? b.accessor<float>("SCALAR", value)
                                                                 : p.components == 3 ? b.accessor<float>("VEC3", value)
                                                                                     : b.accessor<float>("VEC4", value);
    b.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels",
          {{{"sampler", 0},
            {"target",
             {{"path", "pointer"},
              {"extensions",
               {{"KHR_animation_pointer", {{"pointer", "/materials/0/" + std::string(p.pointer)}}}}}}}}}}}};
    const auto scene = b.load();
    ASSERT_TRUE(scene) << p.pointer << ": " << scene.error().text();
    ASSERT_EQ(scene->animations.at(0).channels.size(), 1u) << p.pointer;
    Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), 0);
    const float expected = p.lowest > 0.9 || p.path == TargetPath::material_ior ? 1.f : 0.9f;
    for (int c = 0; c < p.components; ++c) EXPECT_EQ(p.at(pose.materials[0])[c], expected) << p.pointer;
  }
  for (const MaterialTexture& t : material_textures()) {
    const std::string pointer = "/materials/0/" + std::string(t.pointer) + "/extensions/KHR_texture_transform/offset";
    GltfBuilder b = with_extensions(Json::object());
    b.use("KHR_animation_pointer");
    b.json["animations"] = {
        {{"samplers", {{{"input", b.accessor<float>("SCALAR", {0})}, {"output", b.accessor<float>("VEC2", {3, 4})}}}},
         {"channels",
          {{{"sampler", 0},
            {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}}};
    const auto scene = b.load();
    ASSERT_TRUE(scene) << pointer << ": " << scene.error().text();
    Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), 0);
    // Occlusion that was not given goes with metallic-roughness.
    const TextureSlotName slot = t.slot == TextureSlotName::occlusion ? TextureSlotName::orm : t.slot;
    EXPECT_EQ(texture_slot(pose.materials[0], slot).offset, glm::vec2(3, 4)) << pointer;
  }
}

// A lobe that an animation may show later keeps its texture's place; the frame that does not show it does not read it.
TEST(GltfLobes, TexturesOfALobeThatIsNotShownAreNotRead) {
  const auto scene = with_extensions({{"KHR_materials_sheen", {{"sheenColorTexture", {{"index", 0}}}}}}, 1).load();
  ASSERT_TRUE(scene) << scene.error().text();
  int all = 0, shown = 0;
  for_each_slot(scene->materials[0], [&](const TextureSlot& slot, bool) { all += bool(slot); });
  for_each_shown_slot(scene->materials[0], [&](const TextureSlot& slot, bool) { shown += bool(slot); });
  EXPECT_EQ(all, 1);
  EXPECT_EQ(shown, 0);
}

}  // namespace
}  // namespace candela::test
