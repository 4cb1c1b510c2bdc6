#include "scene/survey.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace candela {
namespace {

// Sections of one triangle each, with materials: 0 opaque and textured, 1 unlit blend, 2 used by nobody.
struct Fixture {
  Scene scene;
  Pose pose;
  FrameData frame;
  Fixture() {
    scene.images.resize(4);
    scene.materials.resize(3);
    scene.materials[0].base_color_texture.image = 0;
    scene.materials[0].emissive_texture.image = 1;
    scene.materials[0].normal_texture.image = 2;
    scene.materials[0].normal_texture.uv_set = 1;
    scene.materials[1].alpha_mode = AlphaMode::blend;
    scene.materials[1].unlit = true;
    scene.materials[1].normal_texture.image = 3;
    scene.materials[2].specular = 0;
    scene.meshes.resize(1);
    scene.meshes[0].sections.resize(3);
    for (MeshSection& s : scene.meshes[0].sections) {
      s.position.resize(3);
      s.normal.resize(3);
      s.index = {0, 1, 2};
    }
    scene.meshes[0].sections[2].topology = Topology::points;
    scene.meshes[0].sections[2].normal.clear();
    for (uint32_t s = 0; s < 3; ++s) {
      DrawItem item;
      item.section = s;
      item.material = s < 2 ? int(s) : -1;
      frame.items.push_back(item);
    }
    pose.materials = scene.materials;
  }
};

TEST(Survey, CountsWhatIsDrawn) {
  Fixture f;
  f.frame.items.push_back(f.frame.items[0]);
  f.frame.deformations.push_back({0, 0, 0, 5, 0, 2});
  f.frame.items[0].deformed = f.frame.items[3].deformed = 0;
  f.frame.lights = {{LightType::spot}, {LightType::point}, {LightType::spot}, {LightType::directional}};
  const SceneFacts facts = survey(f.scene, f.pose, f.frame, true);
  EXPECT_EQ(facts.draw_items, 4u);
  EXPECT_EQ(facts.opaque_items, 3u);
  EXPECT_EQ(facts.lit_items, 2u);
  EXPECT_EQ(facts.unlit_items, 1u);  // the points
  EXPECT_EQ(facts.blend_items, 1u);
  EXPECT_EQ(facts.blend_unlit_items, 1u);
  EXPECT_EQ(facts.triangles, 3u);
  EXPECT_EQ(facts.points, 3u);
  EXPECT_EQ(facts.deformed_items, 2u);
  EXPECT_EQ(facts.skinned_items, 2u);
  EXPECT_EQ(facts.morphed_items, 2u);
  EXPECT_EQ(facts.deformed_vertices, 3u);  // shared, so made once
  EXPECT_EQ(facts.spot_lights, 2u);
  EXPECT_EQ(facts.lights(), 4u);
  EXPECT_TRUE(facts.environment);
}

TEST(Survey, OnlyTexturesThatAreSeenCount) {
  Fixture f;
  SceneFacts facts = survey(f.scene, f.pose, f.frame, false);
  EXPECT_EQ(facts.material_used, (std::vector<bool>{true, true, false}));
  // No emission, so its texture is not needed; nor is the normal texture of what is unlit.
  EXPECT_EQ(facts.image_used, (std::vector<bool>{true, false, true, false}));
  EXPECT_TRUE(facts.any_uv1);
  EXPECT_FALSE(facts.any_emissive_texture);
  EXPECT_FALSE(facts.any_specular);
  EXPECT_FALSE(facts.emissive);
  f.pose.materials[0].emissive = glm::vec3(1);
  facts = survey(f.scene, f.pose, f.frame, false);
  EXPECT_TRUE(facts.emissive);
  EXPECT_TRUE(facts.image_used[1]);
}

// Lobes of visible lit materials, and the textures of those that are shown.
TEST(Survey, LobesThatAreSeenCount) {
  Fixture f;
  EXPECT_EQ(survey(f.scene, f.pose, f.frame, false).lobes, 0u);
  Material& m = f.pose.materials[0];
  m.clearcoat.normal_texture.image = 3;
  EXPECT_EQ(survey(f.scene, f.pose, f.frame, false).lobe_textures, 0u) << "a coat of factor 0 is none";
  m.clearcoat.factor = 1;
  m.anisotropy.strength = 0.5;
  f.pose.materials[2].sheen.color = glm::vec3(1);  // not visible
  SceneFacts facts = survey(f.scene, f.pose, f.frame, false);
  EXPECT_EQ(facts.lobes, 1u << uint32_t(Lobe::clearcoat) | 1u << uint32_t(Lobe::anisotropy));
  EXPECT_EQ(facts.lobe_textures, 1u << uint32_t(Lobe::clearcoat));
  EXPECT_TRUE(facts.image_used[3]);
  EXPECT_NE(facts_json(facts).find("clearcoat"), std::string::npos);
  m.unlit = true;
  EXPECT_EQ(survey(f.scene, f.pose, f.frame, false).lobes, 0u);
}

TEST(Survey, PrintsAsJson) {
  Fixture f;
  f.frame.perspective = false;
  const auto json = nlohmann::json::parse(facts_json(survey(f.scene, f.pose, f.frame, false)));
  EXPECT_EQ(json["draw_items"], 3);
  EXPECT_EQ(json["perspective"], false);
  EXPECT_EQ(json["materials_used"], (nlohmann::json{0, 1}));
}

}  // namespace
}  // namespace candela
