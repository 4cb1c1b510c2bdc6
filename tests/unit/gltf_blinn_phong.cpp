// CANDELA_materials_blinn_phong: what is read, what is refused or left out, and its animation.
#include <gtest/gtest.h>

#include "gltf_pointers.h"
#include "scene/material_table.h"
#include "scene/pose.h"

namespace candela::test {
namespace {

GltfBuilder with(Json material, int images = 0) {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
  for (const auto& [name, unused] : material["extensions"].items()) b.use(name.c_str());
  for (int i = 0; i < images; ++i) {
    b.json["images"].push_back({{"uri", png_uri()}});
    b.json["textures"].push_back({{"source", i}});
  }
  b.json["materials"] = {std::move(material)};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  return b;
}
Json blinn_phong(Json values) { return {{"extensions", {{"CANDELA_materials_blinn_phong", std::move(values)}}}}; }

TEST(GltfBlinnPhong, IsReadWithItsMap) {
  Json m = blinn_phong({{"specularFactor", {0.5, 0.25, 0.125}}, {"exponent", 90}, {"specularTexture", {{"index", 1}}}});
  m["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 1, 0.25, 1}},
                               {"metallicFactor", 0.5},
                               {"roughnessFactor", 0.5},
                               {"metallicRoughnessTexture", {{"index", 0}}}};
  const auto scene = with(m, 2).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material& read = scene->materials[0];
  EXPECT_TRUE(read.blinn_phong.shades);
  EXPECT_TRUE(read.blinn_phong.stated);
  EXPECT_EQ(read.blinn_phong.exponent, 90);
  EXPECT_EQ(read.base_color, glm::vec4(0.5f, 1, 0.25f, 1)) << "diffuse";
  EXPECT_EQ(read.specular_color, glm::vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(read.metallic, 0);
  EXPECT_EQ(read.specular_texture.image, 1);
  EXPECT_EQ(read.specular_color_texture.image, 1);
  EXPECT_FALSE(read.orm_texture) << "metal and roughness are not read";
}

TEST(GltfBlinnPhong, WithoutMembersHasItsDefaults) {
  const auto scene = with(blinn_phong(Json::object())).load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->materials[0].blinn_phong.exponent, 32);
  EXPECT_EQ(scene->materials[0].specular_color, glm::vec3(1));
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(GltfBlinnPhong, OtherLayersAreLeftOutWithAWarning) {
  Json m = blinn_phong(Json::object());
  m["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 1}};
  const auto scene = with(m).load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_FALSE(scene->materials[0].has(Lobe::clearcoat));
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_NE(scene->warnings[0].find("CANDELA_materials_blinn_phong"), std::string::npos) << scene->warnings[0];
}

TEST(GltfBlinnPhong, RangesAreKept) {
  for (const Json& values : {Json{{"exponent", -1}}, Json{{"exponent", 2e6}}, Json{{"specularFactor", {2, 0, 0}}}}) {
    const auto scene = with(blinn_phong(values)).load();
    EXPECT_TRUE(!scene || !scene->warnings.empty()) << values.dump();
  }
  EXPECT_FALSE(with(blinn_phong({{"exponent", "shiny"}})).load());
}

TEST(GltfBlinnPhong, FactorsAreAnimated) {
  GltfBuilder b = with(blinn_phong(Json::object()));
  animate_pointers(
      b, {{"/materials/0/extensions/CANDELA_materials_blinn_phong/exponent", "SCALAR", {2, 10}},
          {"/materials/0/extensions/CANDELA_materials_blinn_phong/specularFactor", "VEC3", {0, 0, 0, 1, 0.5f, 0}}});
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), 0.5);
  EXPECT_EQ(pose.materials[0].blinn_phong.exponent, 6);
  EXPECT_EQ(pose.materials[0].specular_color, glm::vec3(0.5f, 0.25f, 0));
}

}  // namespace
}  // namespace candela::test
