#include "scene/light_instances.h"

#include <gtest/gtest.h>

#include <limits>

#include "gltf_builder.h"
#include "scene/frame_data.h"

// CANDELA_light_instances: what is read, what comes out of a frame, and what is refused.
namespace candela {
namespace {

using test::GltfBuilder;
using test::Json;

struct Lamps : GltfBuilder {
  explicit Lamps(const Json& light = {{"name", "Torch"},
                                      {"type", "spot"},
                                      {"color", {1, 0.5, 0.25}},
                                      {"intensity", 10},
                                      {"range", 8},
                                      {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}}) {
    use("KHR_lights_punctual");
    use("CANDELA_light_instances", true);
    json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    json["nodes"] = {{{"name", "lamps"}, {"extensions", {{"CANDELA_light_instances", {{"light", 0}}}}}}};
    set<float>("TRANSLATION", "VEC3", {1, 0, 0, 0, 2, 0, 0, 0, 3});
  }
  Json& extension() { return json["nodes"][0]["extensions"]["CANDELA_light_instances"]; }
  template <class T>
  void set(const char* name, const char* type, const std::vector<T>& values) {
    extension()["attributes"][name] = accessor<T>(type, values);
  }
};

FrameData frame_at(const Scene& scene, double time_s) {
  View view;
  view.position = {100, 0, 0};
  return make_frame_data(scene, evaluate_pose(scene, *choose_animations(scene, "all"), time_s), view);
}

TEST(LightInstances, AreTheTemplateWhereNothingElseIsGiven) {
  const Expected<Scene> scene = Lamps().load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(scene->warnings.empty());
  const FrameData frame = frame_at(*scene, 0);
  ASSERT_EQ(frame.lights.size(), 3u);
  EXPECT_EQ(frame.lights[1].position, glm::vec3(-100, 2, 0));
  EXPECT_EQ(frame.lights[1].intensity, glm::vec3(10, 5, 2.5f));
  EXPECT_EQ(frame.lights[1].direction, glm::vec3(0, 0, -1));
  EXPECT_EQ(frame.lights[1].range_m, 8);
  EXPECT_EQ(frame.lights[1].outer_cone_rad, 0.5f);
}

TEST(LightInstances, AttributesAndTheNodesTransformHold) {
  Lamps b;
  b.set<float>("DIRECTION", "VEC3", {0, -2, 0, 0, 0, -1, 1, 0, 0});
  b.set<float>("COLOR", "VEC3", {1, 1, 1, 0.5f, 0.5f, 0.5f, 0, 1, 0});
  b.set<float>("INTENSITY", "SCALAR", {1, 2, 3});
  b.set<float>("RANGE", "SCALAR", {4, 5, 6});
  // A quarter turn about +Z, twice as large: X becomes Y.
  b.json["nodes"][0]["rotation"] = {0, 0, 0.70710678118, 0.70710678118};
  b.json["nodes"][0]["scale"] = {2, 2, 2};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const FrameData frame = frame_at(*scene, 0);
  ASSERT_EQ(frame.lights.size(), 3u);
  EXPECT_LT(glm::length(frame.lights[0].position - glm::vec3(-100, 2, 0)), 1e-5);
  EXPECT_LT(glm::length(frame.lights[0].direction - glm::vec3(1, 0, 0)), 1e-6);
  EXPECT_LT(glm::length(frame.lights[2].direction - glm::vec3(0, 1, 0)), 1e-6);
  EXPECT_EQ(frame.lights[1].intensity, glm::vec3(10, 5, 2.5f));
  EXPECT_EQ(frame.lights[2].intensity, glm::vec3(0, 15, 0));
  EXPECT_EQ(frame.lights[2].range_m, 6);
}

// The order is that of nodes, and within a node that of its elements, after the node's own light.
TEST(LightInstances, StandInNodeOrder) {
  Lamps b;
  b.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  b.json["nodes"].push_back({{"translation", {0, 9, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.json["scenes"][0]["nodes"] = {1, 0};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const FrameData frame = frame_at(*scene, 0);
  ASSERT_EQ(frame.lights.size(), 5u);
  EXPECT_EQ(frame.lights[0].position.y, 9);
  EXPECT_EQ(frame.lights[1].position, glm::vec3(-100, 0, 0));
  EXPECT_EQ(frame.lights[2].position, glm::vec3(-99, 0, 0));
  EXPECT_EQ(frame.lights[4].position, glm::vec3(-100, 0, 3));
}

TEST(LightInstances, DarkAndHiddenOnesAreLeftOut) {
  Lamps b;
  b.set<float>("INTENSITY", "SCALAR", {1, 0, 1});
  EXPECT_EQ(frame_at(*b.load(), 0).lights.size(), 2u);
  b.use("KHR_node_visibility");
  b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  EXPECT_EQ(frame_at(*b.load(), 0).lights.size(), 0u);
}

TEST(LightInstances, ModulationFollowsTime) {
  const LightModulation m{0.5f, 4, 0.25f};
  EXPECT_EQ(modulation_factor(m, -1), 1);    // phase 0
  EXPECT_EQ(modulation_factor(m, 1), 0.5);   // half a period later: darkest
  EXPECT_EQ(modulation_factor(m, 0), 0.75);  // half way, where the curve is steepest
  EXPECT_EQ(modulation_factor(m, 2.5), modulation_factor(m, -1.5));
  EXPECT_EQ(modulation_factor({0, 1, 0}, 0.3), 1);
  for (double t = -9; t < 9; t += 0.01) {
    EXPECT_GE(modulation_factor(m, t), 0.5);
    EXPECT_LE(modulation_factor(m, t), 1);
  }
  Lamps b;
  b.set<float>("MODULATION", "VEC3", {0, 1, 0, 0.5f, 4, 0.25f, 1, 4, 0.25f});
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(frame_at(*scene, 0).lights[1].intensity, glm::vec3(7.5f, 3.75f, 1.875f));
  EXPECT_EQ(frame_at(*scene, 1).lights.size(), 2u);  // the last one is dark
}

// An animated template moves all of its instances.
TEST(LightInstances, FollowTheTemplatesAnimation) {
  Lamps b;
  b.use("KHR_animation_pointer");
  const int input = b.accessor<float>("SCALAR", {0, 1}), output = b.accessor<float>("SCALAR", {10, 20});
  b.json["animations"] = {
      {{"samplers", {{{"input", input}, {"output", output}}}},
       {"channels",
        {{{"sampler", 0},
          {"target",
           {{"path", "pointer"},
            {"extensions",
             {{"KHR_animation_pointer", {{"pointer", "/extensions/KHR_lights_punctual/lights/0/intensity"}}}}}}}}}}}};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(frame_at(*scene, 0.5).lights[2].intensity.x, 15);
}

struct Wrong {
  const char *name, *type;
  std::vector<float> values;
  const char* says;
};

TEST(LightInstances, RefuseValuesWithoutMeaningByNameAndPath) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Wrong cases[] = {{"INTENSITY", "SCALAR", {1, -1, 1}, "light 1"},
                         {"INTENSITY", "SCALAR", {1, 1, nan}, "element 2"},
                         {"INTENSITY", "SCALAR", {infinity, 1, 1}, "element 0"},
                         {"RANGE", "SCALAR", {1, 1, 0}, "light 2"},
                         {"RANGE", "SCALAR", {-4, 1, 1}, "light 0"},
                         {"RANGE", "SCALAR", {infinity, 1, 1}, "element 0"},
                         {"COLOR", "VEC3", {1, 1, 1, 0, -0.5f, 0, 1, 1, 1}, "light 1"},
                         {"COLOR", "VEC3", {1, 1, 1, 0, 2, 0, 1, 1, 1}, "light 1"},
                         {"DIRECTION", "VEC3", {0, 0, 1, 0, 0, 0, 0, 1, 0}, "light 1"},
                         {"DIRECTION", "VEC3", {0, 0, 1, 0, 1, 0, nan, 1, 0}, "element 2"},
                         {"TRANSLATION", "VEC3", {0, 0, 1, 0, nan, 0, 0, 1, 0}, "element 1"},
                         {"MODULATION", "VEC3", {1.5f, 1, 0, 0, 1, 0, 0, 1, 0}, "light 0"},
                         {"MODULATION", "VEC3", {-0.5f, 1, 0, 0, 1, 0, 0, 1, 0}, "light 0"},
                         {"MODULATION", "VEC3", {0, 1, 0, 0, 0, 0, 0, 1, 0}, "light 1"}};
  for (const Wrong& wrong : cases) {
    Lamps b;
    b.set<float>(wrong.name, wrong.type, wrong.values);
    const Expected<Scene> scene = b.load();
    ASSERT_FALSE(scene) << wrong.name;
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(
        scene.error().place.find(std::string("/nodes/0/extensions/CANDELA_light_instances/attributes/") + wrong.name),
        std::string::npos)
        << scene.error().text();
    EXPECT_NE(scene.error().message.find("'Torch'"), std::string::npos) << scene.error().text();
    EXPECT_NE(scene.error().message.find(wrong.says), std::string::npos) << scene.error().text();
  }
}

void expect_refused(const Lamps& b, const char* path) {
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene) << path;
  EXPECT_EQ(scene.error().kind, ErrorKind::input);
  EXPECT_NE(scene.error().place.find(path), std::string::npos) << scene.error().text();
}

TEST(LightInstances, RefuseFormatsCountsAndReferences) {
  const auto attributes = [](const char* name) { return std::string("CANDELA_light_instances/attributes/") + name; };
  Lamps b;
  b.set<float>("INTENSITY", "VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1});
  expect_refused(b, attributes("INTENSITY").c_str());
  b = Lamps();
  b.set<uint8_t>("COLOR", "VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1});
  expect_refused(b, attributes("COLOR").c_str());
  b = Lamps();
  b.set<float>("RANGE", "SCALAR", {1, 1});
  expect_refused(b, attributes("RANGE").c_str());
  b = Lamps();
  b.set<float>("VELOCITY", "VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1});
  expect_refused(b, attributes("VELOCITY").c_str());
  b = Lamps();
  b.extension()["attributes"]["RANGE"] = 99;
  expect_refused(b, attributes("RANGE").c_str());
  b = Lamps();
  b.extension()["attributes"] = Json::object();
  expect_refused(b, "CANDELA_light_instances/attributes");
  b = Lamps();
  b.extension()["light"] = 1;
  expect_refused(b, "CANDELA_light_instances/light");
  b = Lamps();
  b.extension().erase("light");
  expect_refused(b, "CANDELA_light_instances");
  b = Lamps();
  b.json["extensions"]["KHR_lights_punctual"]["lights"][0] = {{"type", "directional"}};
  expect_refused(b, "CANDELA_light_instances/light");
  b = Lamps();
  b.json["extensions"].erase("KHR_lights_punctual");
  expect_refused(b, "CANDELA_light_instances");
}

TEST(LightInstances, APointLightsDirectionIsWarnedOf) {
  Lamps b({{"name", "Bulb"}, {"type", "point"}});
  b.set<float>("DIRECTION", "VEC3", {0, 0, 1, 0, 1, 0, 1, 1, 0});
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(test::mentions(scene->warnings, "'Bulb'"));
}

}  // namespace
}  // namespace candela
