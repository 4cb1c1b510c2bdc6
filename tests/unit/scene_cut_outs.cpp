#include "scene/cut_outs.h"

#include <gtest/gtest.h>

#include "testscenes/procedural_textures.h"

namespace candela {
namespace {

// One blended material on one triangle, whose texture's alpha is `alpha` of the column, 0 to 1.
Scene leaf(const std::function<double(double)>& alpha) {
  Scene scene;
  SceneImage image;
  image.place = "leaf";
  image.encoded = png_from(32, 8, 4, [&](double u, double) { return glm::dvec4(0.2, 0.7, 0.3, alpha(u)); });
  scene.images.push_back(std::move(image));
  Material m;
  m.alpha_mode = AlphaMode::blend;
  m.base_color_texture.image = 0;
  scene.materials.push_back(m);
  MeshSection section;
  section.material = 0;
  section.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  section.color = {{1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 1}};
  scene.meshes.emplace_back().sections.push_back(section);
  return scene;
}
const auto hard = [](double u) { return u < 0.5 ? 0.0 : 1.0; };

TEST(CutOuts, AreWhatHidesAllOrNothing) {
  EXPECT_EQ(cut_out_materials(leaf(hard)), std::vector<uint32_t>{0});
  EXPECT_EQ(cut_out_materials(leaf([](double u) { return u < 0.5 ? 1.0 / 255 : 254.0 / 255; })),
            std::vector<uint32_t>{0});
  EXPECT_TRUE(cut_out_materials(leaf([](double u) { return u < 0.5 ? 2.0 / 255 : 1.0; })).empty());
  EXPECT_TRUE(cut_out_materials(leaf([](double u) { return u; })).empty());
  Scene scene = leaf(hard);
  scene.materials[0].base_color.w = 0.5f;
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "the factor";
  scene = leaf(hard);
  scene.meshes[0].sections[0].color[1].w = 0.5f;
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "a corner";
  scene = leaf(hard);
  scene.materials[0].base_color_texture.image = -1;
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "no texture";
  scene = leaf(hard);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "a mask already";
  scene = leaf(hard);
  scene.images[0].encoded.resize(20);
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "a damaged image";
  scene = leaf(hard);
  AnimationChannel fades;
  fades.path = TargetPath::material_base_color, fades.object = 0;
  scene.animations.emplace_back().channels.push_back(fades);
  EXPECT_TRUE(cut_out_materials(scene).empty()) << "animated";
  scene.animations[0].channels[0].element = 1;
  EXPECT_FALSE(cut_out_materials(scene).empty()) << "another component is";
}

// What blends and hides all is opaque, by material, texture, corners and animations.
TEST(CutOuts, WhatCoversAllIsOpaque) {
  const auto covering = [](const std::function<void(Scene&)>& change) {
    Scene scene = leaf([](double) { return 1.0; });
    scene.images[0].encoded =
        png_from(32, 8, 3, [](double u, double) { return glm::dvec4(0.2, u, 0.3, 1); });  // without an alpha
    scene.meshes[0].sections[0].color.assign(3, glm::vec4(1));
    change(scene);
    const AlphaMode before = scene.materials[0].alpha_mode;
    const bool found = make_covering_opaque(scene) == std::vector<uint32_t>{0};
    EXPECT_EQ(scene.materials[0].alpha_mode, found ? AlphaMode::opaque : before);
    return found;
  };
  EXPECT_TRUE(covering([](Scene&) {}));
  EXPECT_TRUE(covering([](Scene& s) { s.materials[0].base_color_texture.image = -1; })) << "no texture";
  EXPECT_TRUE(covering([](Scene& s) { s.meshes[0].sections[0].color.clear(); })) << "no colours of corners";
  EXPECT_FALSE(covering([](Scene& s) { s.materials[0].base_color.w = 0.999f; })) << "the factor";
  EXPECT_FALSE(covering([](Scene& s) { s.images = leaf(hard).images; })) << "the texture";
  EXPECT_FALSE(covering([](Scene& s) { s.images[0].encoded.resize(20); })) << "a damaged image";
  EXPECT_FALSE(covering([](Scene& s) { s.meshes[0].sections[0].color[1].w = 0.5f; })) << "a corner";
  EXPECT_FALSE(covering([](Scene& s) { s.materials[0].alpha_mode = AlphaMode::mask; })) << "a mask";
  EXPECT_FALSE(covering([](Scene& s) {
    AnimationChannel fades;
    fades.path = TargetPath::material_base_color, fades.object = 0, fades.element = 3;
    s.animations.emplace_back().channels.push_back(fades);
  })) << "it fades";
}

TEST(CutOuts, AreMaskedWhereThatIsAskedFor) {
  Scene scene = leaf(hard);
  apply_cut_outs(scene, "blended");
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::blend);
  apply_cut_outs(scene, "masked");
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::mask);
  EXPECT_EQ(scene.materials[0].alpha_cutoff, 0.5f);
}

}  // namespace
}  // namespace candela
