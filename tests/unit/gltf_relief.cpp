// CANDELA_relief: what is read, what is refused or left out, and its animation.
#include <gtest/gtest.h>

#include "gltf_pointers.h"
#include "scene/geometry_layout.h"
#include "scene/material_table.h"
#include "scene/pose.h"

namespace candela::test {
namespace {

GltfBuilder with(Json extension, Json material = Json::object()) {
  GltfBuilder b;
  b.triangle();
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 0, 2, 0.5f, -1, 1});
  b.use("CANDELA_relief");
  b.json["images"].push_back({{"uri", png_uri()}});
  b.json["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9728}, {"wrapS", 33071}}};
  b.json["textures"].push_back({{"source", 0}, {"sampler", 0}});
  material["extensions"]["CANDELA_relief"] = std::move(extension);
  b.json["materials"] = {std::move(material)};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  return b;
}
Json height(double depth) { return {{"heightTexture", {{"index", 0}}}, {"depth", depth}}; }

TEST(GltfRelief, IsReadWithItsTexture) {
  const auto scene = with(height(0.25)).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Material& m = scene->materials[0];
  EXPECT_TRUE(m.has_relief());
  EXPECT_EQ(m.relief.depth, 0.25f);
  EXPECT_TRUE(m.relief.silhouettes);
  EXPECT_EQ(m.relief.texture.image, 0);
  EXPECT_TRUE(scene->warnings.empty());
  const Sampler& sampler = scene->samplers[size_t(m.relief.texture.sampler)];
  EXPECT_EQ(sampler.mag, Filter::linear) << "heights are bilinear whatever the sampler's filter";
  EXPECT_EQ(sampler.wrap_u, Wrap::clamp);
  EXPECT_EQ(sampler.wrap_v, Wrap::repeat);
}

TEST(GltfRelief, WhereItEndsStandsBeforeItsTextureCoordinates) {
  const auto scene = with(height(0.25)).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const auto layout = layout_geometry(*scene);
  ASSERT_TRUE(layout) << layout.error().text();
  std::vector<uint32_t> words(layout->vertex_words), indices(layout->index_count);
  pack_geometry(*scene, *layout, words, indices);
  float bounds[4];
  std::memcpy(bounds, words.data() + layout->sections[0][0].uv0 - 4, sizeof bounds);
  EXPECT_EQ(std::vector<float>(bounds, bounds + 4), (std::vector<float>{-1, 0, 2, 1}));
}

TEST(GltfRelief, DepthZeroIsNone) {
  const auto scene = with(height(0)).load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_FALSE(scene->materials[0].has_relief());
}

TEST(GltfRelief, IsOfOpaqueMaterialsAlone) {
  Json glass;
  glass["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  for (const Json& material : {Json{{"alphaMode", "MASK"}}, Json{{"alphaMode", "BLEND"}}, glass}) {
    GltfBuilder b = with(height(1), material);
    b.use("KHR_materials_transmission");
    const auto scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_FALSE(scene->materials[0].has_relief()) << material.dump();
    ASSERT_EQ(scene->warnings.size(), 1u) << material.dump();
    EXPECT_NE(scene->warnings[0].find("/materials/0/extensions/CANDELA_relief"), std::string::npos)
        << scene->warnings[0];
  }
}

TEST(GltfRelief, WhatIsWrongIsRefusedWithItsPlace) {
  const auto refused = [](Json extension, const std::string& place) {
    const auto scene = with(std::move(extension)).load();
    ASSERT_FALSE(scene);
    EXPECT_NE(scene.error().text().find(place), std::string::npos) << scene.error().text();
  };
  refused({{"depth", 1}}, "heightTexture");
  refused({{"heightTexture", {{"index", 0}}}}, "depth");
  refused({{"heightTexture", {{"index", 0}}}, {"depth", "deep"}}, "/materials/0/extensions/CANDELA_relief/depth");
  refused({{"heightTexture", {{"index", 0}}}, {"depth", 1}, {"silhouettes", 2}},
          "/materials/0/extensions/CANDELA_relief/silhouettes");
  const auto below = with(height(-1)).load();
  EXPECT_TRUE(!below || !below->warnings.empty());
}

TEST(GltfRelief, DepthAndTransformAreAnimated) {
  Json extension = height(1);
  extension["heightTexture"]["extensions"]["KHR_texture_transform"] = {{"offset", {0, 0}}};
  GltfBuilder b = with(extension);
  b.use("KHR_texture_transform");
  animate_pointers(b, {{"/materials/0/extensions/CANDELA_relief/depth", "SCALAR", {0, 0.5f}},
                       {"/materials/0/extensions/CANDELA_relief/heightTexture/extensions/KHR_texture_transform/offset",
                        "VEC2",
                        {0, 0, 1, 0.5f}}});
  const auto scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), 0.5);
  EXPECT_EQ(pose.materials[0].relief.depth, 0.25f);
  EXPECT_EQ(pose.materials[0].relief.texture.offset, glm::vec2(0.5f, 0.25f));
}

}  // namespace
}  // namespace candela::test
