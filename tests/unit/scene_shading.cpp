#include "scene/shading.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

Material gold() {
  Material m;
  m.base_color = {1, 0.7f, 0.3f, 0.5f};
  m.metallic = 1, m.roughness = 0.1f;
  m.specular = 1, m.transmission = 0.5f, m.thickness_m = 2, m.dispersion = 1;
  m.emissive = {1, 2, 3};
  m.normal_texture.image = 0, m.orm_texture.image = 1, m.specular_texture.image = 2;
  m.orm_has_metallic_roughness = true;
  return m;
}

TEST(Shading, LambertLeavesTheBaseColourAlone) {
  Scene scene;
  scene.materials = {gold()};
  apply_shading(scene, "lambert");
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 1);
  EXPECT_EQ(m.specular, 0);
  EXPECT_EQ(m.transmission, 0);
  EXPECT_EQ(m.thickness_m, 0);
  EXPECT_EQ(m.dispersion, 0);
  EXPECT_FALSE(m.orm_texture) << "nothing of it is read";
  EXPECT_FALSE(m.specular_texture);
  EXPECT_TRUE(m.normal_texture);
  EXPECT_EQ(m.base_color, gold().base_color);
  EXPECT_EQ(m.emissive, gold().emissive);
  EXPECT_EQ(scene.default_material.metallic, 0);
  EXPECT_EQ(scene.default_material.specular, 0);
}

TEST(Shading, BlinnPhongLeavesTheBaseWithoutLayers) {
  Scene scene;
  scene.materials = {gold(), gold()};
  scene.materials[0].clearcoat.factor = scene.materials[0].anisotropy.strength = 1;
  scene.materials[1].unlit = true;
  scene.animations.resize(1);
  for (const TargetPath path : {TargetPath::material_metallic, TargetPath::material_base_color,
                                TargetPath::material_clearcoat, TargetPath::material_transmission})
    scene.animations[0].channels.push_back({.path = path});
  apply_shading(scene, "blinn-phong");
  const Material& m = scene.materials[0];
  EXPECT_TRUE(m.blinn_phong.shades);
  EXPECT_FALSE(m.blinn_phong.stated) << "the exponent is that of its roughness";
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 0.1f);
  EXPECT_TRUE(m.orm_texture);
  EXPECT_TRUE(m.specular_texture);
  for (int lobe = 0; lobe < lobe_count; ++lobe) EXPECT_FALSE(m.has(Lobe(lobe))) << lobe;
  EXPECT_FALSE(scene.materials[1].blinn_phong.shades) << "unlit";
  EXPECT_TRUE(scene.default_material.blinn_phong.shades);
  ASSERT_EQ(scene.animations[0].channels.size(), 2u);
  EXPECT_EQ(scene.animations[0].channels[1].path, TargetPath::material_base_color);
  apply_shading(scene, "lambert");
  EXPECT_FALSE(m.blinn_phong.shades);
}

TEST(Shading, OcclusionInTheSameTextureStays) {
  Scene scene;
  scene.materials = {gold()};
  scene.materials[0].orm_has_occlusion = true;
  apply_shading(scene, "lambert");
  EXPECT_TRUE(scene.materials[0].orm_texture);
  EXPECT_FALSE(scene.materials[0].orm_has_metallic_roughness);
}

TEST(Shading, NoAnimationBringsGlossBack) {
  Scene scene;
  scene.animations.resize(1);
  for (const TargetPath path : {TargetPath::material_metallic, TargetPath::material_base_color,
                                TargetPath::material_specular_color, TargetPath::node_translation})
    scene.animations[0].channels.push_back({.path = path});
  apply_shading(scene, "lambert");
  ASSERT_EQ(scene.animations[0].channels.size(), 2u);
  EXPECT_EQ(scene.animations[0].channels[0].path, TargetPath::material_base_color);
  EXPECT_EQ(scene.animations[0].channels[1].path, TargetPath::node_translation);
}

TEST(Shading, UnlitMaterialsAndPbrStay) {
  Scene scene;
  scene.materials = {gold()};
  scene.materials[0].unlit = true;
  apply_shading(scene, "lambert");
  EXPECT_EQ(scene.materials[0].metallic, 1);
  scene.materials[0].unlit = false;
  apply_shading(scene, "pbr");
  EXPECT_EQ(scene.materials[0].metallic, 1);
  EXPECT_TRUE(scene.materials[0].orm_texture);
}

}  // namespace
}  // namespace candela
