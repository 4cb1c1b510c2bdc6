#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/frame_data.h"

namespace candela::test {
namespace {

TEST(GltfScene, DeepHierarchiesDoNotOverflowTheStack) {
  GltfBuilder b;
  const int count = 100000;
  b.json["nodes"] = Json::array();
  for (int i = 0; i + 1 < count; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
  b.json["nodes"].push_back({{"translation", {1, 2, 3}}});
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  ASSERT_EQ(scene->order.size(), size_t(count));
  for (int i = 0; i < count; ++i) ASSERT_EQ(scene->order[size_t(i)], i);
  EXPECT_EQ(scene->nodes.back().parent, count - 2);
}

TEST(GltfScene, LoopsAreRefused) {
  GltfBuilder b;
  b.json["scenes"][0]["nodes"] = {0, 1};
  b.json["nodes"] = {{{"children", {3}}}, {{"children", {2}}}, {{"children", {1}}}, Json::object()};
  Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("NODE_LOOP"), std::string::npos) << scene.error().text();
  b.json["nodes"] = {Json::object(), {{"children", {2}}}, {{"children", {1}}}};
  scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("NODE_LOOP"), std::string::npos) << scene.error().text();
  b.json["scenes"][0]["nodes"] = {0};  // of nodes that are not shown
  EXPECT_TRUE(b.load());
}

TEST(GltfScene, ChoosesTheNamedSceneAndParentsComeFirst) {
  GltfBuilder b;
  b.json["nodes"] = {{{"name", "a"}}, {{"children", {3, 0}}}, {{"name", "other"}}, {{"children", {4}}}, Json::object()};
  b.json["scenes"] = {{{"nodes", {2}}}, {{"nodes", {1}}}};
  b.json["scene"] = 1;
  Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->roots, std::vector<int>{1});
  EXPECT_EQ(scene->order, (std::vector<int>{1, 3, 4, 0}));
  b.json.erase("scene");
  EXPECT_EQ(b.load()->roots, std::vector<int>{2});
  b.json.erase("scenes");
  scene = b.load();
  EXPECT_EQ(scene->roots, (std::vector<int>{1, 2}));
  EXPECT_TRUE(mentions(scene->warnings, "no scene"));
}

TEST(GltfScene, JointsOutsideTheSceneArePlacedButNotDrawn) {
  GltfBuilder b;
  b.primitive({{"POSITION", b.accessor<float>("VEC3", {0, 0, 0})},
               {"JOINTS_0", b.accessor<uint8_t>("VEC4", {0, 0, 0, 0})},
               {"WEIGHTS_0", b.accessor<float>("VEC4", {1, 0, 0, 0})}},
              0);
  b.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"children", {2}}}, Json::object()};
  b.json["skins"] = {{{"joints", {2}}}};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->order, (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(scene->nodes[0].visible);
  EXPECT_FALSE(scene->nodes[1].visible);
}

TEST(GltfScene, TransformsVisibilityAndInstances) {
  GltfBuilder b;
  b.triangle();
  b.use("KHR_node_visibility");
  b.use("EXT_mesh_gpu_instancing", true);
  const int translation = b.accessor<float>("VEC3", {1, 2, 3, 4, 5, 6});
  const int rotation = b.accessor<int8_t>("VEC4", {0, 0, 0, 127, 127, 0, 0, 0}, true);
  b.json["nodes"] = {
      {{"mesh", 0},
       {"rotation", {0, 0, 0.6, 0.8}},
       {"extensions",
        {{"KHR_node_visibility", {{"visible", false}}},
         {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translation}, {"ROTATION", rotation}}}}}}}},
      {{"matrix", {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 7, 8, 9, 1}}}};
  b.json["scenes"][0]["nodes"] = {0, 1};
  Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const Node& node = scene->nodes[0];
  EXPECT_FALSE(node.visible);
  EXPECT_DOUBLE_EQ(node.rotation.w, 0.8);
  EXPECT_DOUBLE_EQ(node.rotation.z, 0.6);
  ASSERT_TRUE(node.instances);
  EXPECT_EQ(node.instances->count, 2u);
  EXPECT_EQ(node.instances->translation[1], glm::vec3(4, 5, 6));
  EXPECT_EQ(node.instances->rotation[1].x, 1.f);
  EXPECT_TRUE(node.instances->scale.empty());
  EXPECT_EQ(scene->nodes[1].matrix[3], glm::dvec4(7, 8, 9, 1));
  EXPECT_TRUE(scene->nodes[1].has_matrix);
  // Attributes of different lengths describe no set of instances.
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      b.accessor<float>("VEC3", {1, 1, 1});
  EXPECT_FALSE(b.load());
}

GltfBuilder with_light(const Json& light) {
  GltfBuilder b;
  b.use("KHR_lights_punctual", true);
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  b.json["nodes"] = {{{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  return b;
}

TEST(GltfScene, LightsWithDefaultsAndUnits) {
  Expected<Scene> scene = with_light({{"type", "spot"}, {"spot", Json::object()}}).load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->nodes[0].light, 0);
  EXPECT_EQ(scene->lights[0].type, LightType::spot);
  EXPECT_EQ(scene->lights[0].intensity, 1);
  EXPECT_EQ(scene->lights[0].color, glm::vec3(1));
  EXPECT_TRUE(std::isinf(scene->lights[0].range_m));
  EXPECT_FLOAT_EQ(scene->lights[0].outer_cone_rad, 0.78539816f);
  scene = with_light({{"type", "directional"}, {"intensity", 100000}, {"color", {1, 0.5, 0}}}).load();
  EXPECT_EQ(scene->lights[0].intensity, 100000);
  EXPECT_EQ(scene->lights[0].color, glm::vec3(1, 0.5, 0));
}

TEST(GltfScene, LightsWithoutMeaningAreRefusedByPath) {
  const Json cases = {{{"type", "point"}, {"intensity", -1}},

                      {{"type", "point"}, {"range", -2}},
                      {{"type", "point"}, {"color", {-0.5, 0, 0}}},

                      {{"type", "spot"}, {"spot", {{"innerConeAngle", -0.1}}}},
                      {{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}},
                      {{"type", "lamp"}}};
  for (Json light : cases) {
    light["name"] = "Torch";
    const Expected<Scene> scene = with_light(light).load();
    ASSERT_FALSE(scene) << light;
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(scene.error().place.find("/extensions/KHR_lights_punctual/lights/0"), std::string::npos)
        << scene.error().text();
    EXPECT_NE(scene.error().text().find("Torch"), std::string::npos) << scene.error().text();
  }
}

// JSON has no NaN and no infinity; what a float cannot hold is the nearest thing.
TEST(GltfScene, LightsBeyondAFloatAreRefused) {
  for (const char* member : {R"("intensity":1e39)", R"("color":[1e39,0,0])", R"("range":1e-50)"}) {
    const Json light = Json::parse(std::string(R"({"name":"Torch","type":"point",)") + member + "}");
    const Expected<Scene> scene = with_light(light).load();
    ASSERT_FALSE(scene) << light;
    EXPECT_NE(scene.error().text().find("Torch"), std::string::npos) << scene.error().text();
  }
}

TEST(GltfScene, LampsHaveASize) {
  const auto with_size = [](Json light, Json size) {
    light["name"] = "Torch";
    light["extensions"]["CANDELA_light_size"] = std::move(size);
    GltfBuilder b = with_light(light);
    b.use("CANDELA_light_size", true);
    return b.load();
  };
  const Expected<Scene> point = with_size({{"type", "point"}}, {{"radius", 0.25}}),
                        spot = with_size({{"type", "spot"}, {"spot", Json::object()}}, {{"radius", 0}}),
                        without = with_light({{"type", "point"}}).load();
  ASSERT_TRUE(point && spot && without) << point.error().text();
  EXPECT_TRUE(point->warnings.empty());
  EXPECT_EQ(point->extensions[1].support, Support::supported);
  EXPECT_EQ(point->lights[0].radius_m, 0.25f);
  EXPECT_EQ(spot->lights[0].radius_m, 0.0f);
  EXPECT_FALSE(without->lights[0].radius_m);
  // What says nothing has the radius that the look gives; 0 is said.
  const auto radius = [](const Scene& scene) {
    return make_frame_data(scene, evaluate_pose(scene, {}, 0), View{}, 0.5).lights.at(0).radius_m;
  };
  EXPECT_EQ(radius(*point), 0.25f);
  EXPECT_EQ(radius(*spot), 0);
  EXPECT_EQ(radius(*without), 0.5f);
  EXPECT_EQ(radius(*with_light({{"type", "directional"}}).load()), 0);
  struct Wrong {
    Json light, size;
    const char* place;
  };
  const std::string at = "/extensions/KHR_lights_punctual/lights/0";
  for (const Wrong& wrong : {Wrong{{{"type", "point"}}, {{"radius", -0.1}}, "/radius"},
                             {{{"type", "point"}}, {{"radius", 1e39}}, "/radius"},
                             {{{"type", "point"}}, {{"radius", "1"}}, "/radius"},
                             {{{"type", "point"}}, Json::object(), ""},
                             {{{"type", "directional"}}, {{"radius", 1}}, ""}}) {
    const Expected<Scene> scene = with_size(wrong.light, wrong.size);
    ASSERT_FALSE(scene) << wrong.light << wrong.size;
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(scene.error().text().find("CANDELA_light_size" + std::string(wrong.place)), std::string::npos)
        << scene.error().text();
    EXPECT_NE(scene.error().text().find(at), std::string::npos) << scene.error().text();
    EXPECT_NE(scene.error().text().find("Torch"), std::string::npos) << scene.error().text();
  }
}

TEST(GltfScene, EqualConeAnglesAreASharpEdgeWithAWarning) {
  const Expected<Scene> scene =
      with_light({{"name", "Torch"}, {"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}})
          .load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(
      test::mentions(scene->warnings, "/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle: light 'Torch'"));
}

TEST(GltfScene, AnimatedLightsOutsideTheirRangeAreWarnedOfAtLoad) {
  const auto driven = [](const char* property, const std::string& type, std::vector<float> values,
                         const char* interpolation) {
    GltfBuilder b = with_light({{"name", "Torch"}, {"type", "spot"}, {"spot", Json::object()}});
    b.use("KHR_animation_pointer");
    const int input = b.accessor<float>("SCALAR", {0, 1}), output = b.accessor<float>(type, values);
    b.json["animations"] = {
        {{"name", "blaze"},
         {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
         {"channels",
          {{{"sampler", 0},
            {"target",
             {{"path", "pointer"},
              {"extensions",
               {{"KHR_animation_pointer",
                 {{"pointer", std::string("/extensions/KHR_lights_punctual/lights/0/") + property}}}}}}}}}}}};
    const Expected<Scene> scene = b.load();
    EXPECT_TRUE(scene) << scene.error().text();
    return scene->warnings;
  };
  const std::string place = "/extensions/KHR_lights_punctual/lights/0 'Torch': animation 0 'blaze'";
  EXPECT_TRUE(test::mentions(driven("intensity", "SCALAR", {1, -1}, "LINEAR"), place));
  EXPECT_TRUE(test::mentions(driven("range", "SCALAR", {0, 1}, "LINEAR"), place));
  EXPECT_TRUE(test::mentions(driven("color", "VEC3", {0, 0, 0, 1, -1, 0}, "STEP"), place));
  EXPECT_TRUE(test::mentions(driven("spot/outerConeAngle", "SCALAR", {1, 2}, "LINEAR"), place));
  EXPECT_TRUE(driven("intensity", "SCALAR", {1, 0}, "LINEAR").empty());
  // Tangents may be anything.
  EXPECT_TRUE(driven("intensity", "SCALAR", {-9, 1, -9, -9, 1, -9}, "CUBICSPLINE").empty());
  EXPECT_TRUE(test::mentions(driven("intensity", "SCALAR", {0, 1, 0, 0, -1, 0}, "CUBICSPLINE"), place));
}

TEST(GltfScene, VersionsAreReadAsTheSpecificationSays) {
  GltfBuilder b;
  b.triangle();
  b.json["asset"] = {{"version", "2.7"}};
  EXPECT_TRUE(b.load());
  b.json["asset"] = {{"version", "2.7"}, {"minVersion", "2.1"}};
  EXPECT_FALSE(b.load());
  b.json["asset"] = {{"version", "1.0"}};
  EXPECT_FALSE(b.load());
  b.json["asset"] = {{"version", "3.0"}};
  EXPECT_FALSE(b.load());
}

TEST(GltfScene, ExtensionsAreListedWithTheirUsers) {
  GltfBuilder b;
  b.triangle();
  b.use("KHR_materials_subsurface");
  b.use("KHR_materials_unlit");
  b.use("ACME_thing");
  b.json["materials"] = {
      {{"name", "lacquer"},
       {"extensions", {{"KHR_materials_subsurface", Json::object()}, {"KHR_materials_unlit", Json::object()}}}}};
  b.json["nodes"][0]["extensions"]["ACME_thing"] = Json::object();
  b.json["nodes"][0]["name"] = "hull";
  Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  ASSERT_EQ(scene->extensions.size(), 3u);
  EXPECT_EQ(scene->extensions[0].support, Support::ignored);
  EXPECT_EQ(scene->extensions[0].users, std::vector<std::string>{"/materials/0 'lacquer'"});
  EXPECT_NE(scene->extensions[0].consequence, "");
  EXPECT_EQ(scene->extensions[1].support, Support::supported);
  EXPECT_TRUE(scene->materials[0].unlit);
  b.json["extensionsRequired"] = {"ACME_thing"};
  scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::input);
  EXPECT_NE(scene.error().message.find("ACME_thing"), std::string::npos);
  EXPECT_NE(scene.error().message.find("/nodes/0 'hull'"), std::string::npos) << scene.error().text();
}

// One key of each property that KHR_animation_pointer may drive here.
struct PointerCase {
  const char* pointer;
  TargetPath path;
  int object, element, components;
};
class GltfPointer : public testing::TestWithParam<PointerCase> {};

GltfBuilder pointer_file() {
  GltfBuilder b;
  for (const char* name : {"KHR_animation_pointer", "KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_ior",
                           "KHR_materials_specular", "KHR_materials_emissive_strength", "KHR_node_visibility"})
    b.use(name);
  Json& p = b.primitive({{"POSITION", b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}});
  const int delta = b.accessor<float>("VEC3", std::vector<float>(9, 1.f));
  p["targets"] = {{{"POSITION", delta}}, {{"POSITION", delta}}};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", Json::object()}}};
  b.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}}};
  b.json["images"] = {{{"uri", png_uri()}}};
  b.json["textures"] = {{{"source", 0}}};
  const Json texture = {{"index", 0}};
  b.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", texture}, {"metallicRoughnessTexture", texture}}},
       {"occlusionTexture", texture},
       {"normalTexture", texture},
       {"emissiveTexture", texture}}};
  return b;
}

void animate(GltfBuilder& b, const std::string& pointer, int components) {
  const int times = b.accessor<float>("SCALAR", {0.f, 2.f});
  const int values = b.accessor<float>("SCALAR", std::vector<float>(size_t(2 * components), 0.5f));
  if (components > 1 && components <= 4 && pointer.find("weights") == std::string::npos) {
    b.json["accessors"][size_t(values)]["type"] = fmt::format("VEC{}", components);
    b.json["accessors"][size_t(values)]["count"] = 2;
    b.json["accessors"][size_t(values)].erase("min");
    b.json["accessors"][size_t(values)].erase("max");
  }
  b.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", values}, {"interpolation", "STEP"}}}},
       {"channels",
        {{{"sampler", 0},
          {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}}};
}

TEST_P(GltfPointer, DrivesItsProperty) {
  const PointerCase& c = GetParam();
  GltfBuilder b = pointer_file();
  animate(b, c.pointer, c.components);
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  ASSERT_EQ(scene->animations.at(0).channels.size(), 1u)
      << c.pointer << (scene->warnings.empty() ? "" : scene->warnings.back());
  const AnimationChannel& channel = scene->animations[0].channels[0];
  EXPECT_EQ(channel.path, c.path);
  EXPECT_EQ(channel.object, c.object);
  EXPECT_EQ(channel.element, c.element);
  EXPECT_EQ(channel.components, c.components);
  EXPECT_EQ(scene->animations[0].end_s, 2);
}

#define MATERIAL "/materials/0/"
#define LIGHT "/extensions/KHR_lights_punctual/lights/0/"
#define TRANSFORM "/extensions/KHR_texture_transform/"
using enum TargetPath;
INSTANTIATE_TEST_SUITE_P(
    All, GltfPointer,
    testing::Values(
        PointerCase{"/nodes/0/translation", node_translation, 0, -1, 3},
        PointerCase{"/nodes/0/rotation", node_rotation, 0, -1, 4}, PointerCase{"/nodes/0/scale", node_scale, 0, -1, 3},
        PointerCase{"/nodes/0/weights", node_weights, 0, -1, 2},
        PointerCase{"/nodes/0/weights/1", node_weights, 0, 1, 1},
        PointerCase{"/meshes/0/weights", node_weights, 0, -1, 2},
        PointerCase{"/nodes/0/extensions/KHR_node_visibility/visible", node_visible, 0, -1, 1},
        PointerCase{MATERIAL "pbrMetallicRoughness/baseColorFactor", material_base_color, 0, -1, 4},
        PointerCase{MATERIAL "pbrMetallicRoughness/baseColorFactor/3", material_base_color, 0, 3, 1},
        PointerCase{MATERIAL "pbrMetallicRoughness/metallicFactor", material_metallic, 0, -1, 1},
        PointerCase{MATERIAL "pbrMetallicRoughness/roughnessFactor", material_roughness, 0, -1, 1},
        PointerCase{MATERIAL "emissiveFactor", material_emissive, 0, -1, 3},
        PointerCase{MATERIAL "alphaCutoff", material_alpha_cutoff, 0, -1, 1},
        PointerCase{MATERIAL "normalTexture/scale", material_normal_scale, 0, -1, 1},
        PointerCase{MATERIAL "occlusionTexture/strength", material_occlusion_strength, 0, -1, 1},
        PointerCase{MATERIAL "extensions/KHR_materials_emissive_strength/emissiveStrength", material_emissive_strength,
                    0, -1, 1},
        PointerCase{MATERIAL "extensions/KHR_materials_ior/ior", material_ior, 0, -1, 1},
        PointerCase{MATERIAL "extensions/KHR_materials_specular/specularFactor", material_specular, 0, -1, 1},
        PointerCase{MATERIAL "extensions/KHR_materials_specular/specularColorFactor", material_specular_color, 0, -1,
                    3},
        PointerCase{MATERIAL "pbrMetallicRoughness/baseColorTexture" TRANSFORM "offset", texture_offset, 0,
                    int(TextureSlotName::base_color), 2},
        PointerCase{MATERIAL "normalTexture" TRANSFORM "rotation", texture_rotation, 0, int(TextureSlotName::normal),
                    1},
        PointerCase{MATERIAL "emissiveTexture" TRANSFORM "scale", texture_scale, 0, int(TextureSlotName::emissive), 2},
        PointerCase{MATERIAL "occlusionTexture" TRANSFORM "scale", texture_scale, 0, int(TextureSlotName::occlusion),
                    2},
        PointerCase{LIGHT "color", light_color, 0, -1, 3}, PointerCase{LIGHT "intensity", light_intensity, 0, -1, 1},
        PointerCase{LIGHT "range", light_range, 0, -1, 1},
        PointerCase{LIGHT "spot/innerConeAngle", light_inner_cone, 0, -1, 1},
        PointerCase{LIGHT "spot/outerConeAngle", light_outer_cone, 0, -1, 1},
        PointerCase{"/cameras/0/perspective/yfov", camera_yfov, 0, -1, 1},
        PointerCase{"/cameras/0/perspective/aspectRatio", camera_aspect, 0, -1, 1},
        PointerCase{"/cameras/0/perspective/znear", camera_near, 0, -1, 1},
        PointerCase{"/cameras/0/perspective/zfar", camera_far, 0, -1, 1},
        PointerCase{"/cameras/1/orthographic/xmag", camera_xmag, 1, -1, 1},
        PointerCase{"/cameras/1/orthographic/ymag", camera_ymag, 1, -1, 1},
        PointerCase{"/cameras/1/orthographic/zfar", camera_far, 1, -1, 1}));

TEST(GltfAnimation, UnknownPointersAreWarningsThatNameThem) {
  GltfBuilder b = pointer_file();
  animate(b, "/materials/0/extensions/KHR_materials_sheen/sheenGlow", 1);
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(scene->animations.at(0).channels.empty());
  EXPECT_TRUE(mentions(scene->warnings, "/materials/0/extensions/KHR_materials_sheen/sheenGlow"));
}

// The output accessor is the one that the caller adds next.
GltfBuilder animated(const std::string& path, const std::string& interpolation, std::vector<float> times) {
  GltfBuilder b;
  b.triangle();
  const int input = b.accessor<float>("SCALAR", times);
  b.json["animations"] = {{{"name", "move"},
                           {"samplers", {{{"input", input}, {"output", input + 1}, {"interpolation", interpolation}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
  return b;
}

TEST(GltfAnimation, InterpolationsAndNormalisedRotations) {
  GltfBuilder b = animated("rotation", "LINEAR", {0.f, 1.f});
  b.accessor<int16_t>("VEC4", {0, 0, 0, 32767, 32767, 0, 0, -32768}, true);
  Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->animations[0].channels.at(0).values, (std::vector<float>{0, 0, 0, 1, 1, 0, 0, -1}));

  GltfBuilder cubic = animated("translation", "CUBICSPLINE", {0.f, 1.f});
  cubic.accessor<float>("VEC3", std::vector<float>(18, 2.f));
  scene = cubic.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->animations[0].channels.at(0).interpolation, Interpolation::cubic_spline);
  EXPECT_EQ(scene->animations[0].channels[0].values.size(), 18u);

  GltfBuilder wrong = animated("translation", "LINEAR", {0.f, 1.f});
  wrong.accessor<float>("VEC3", std::vector<float>(9, 2.f));
  EXPECT_FALSE(wrong.load()) << "three values for two keys";
  GltfBuilder backwards = animated("translation", "LINEAR", {1.f, 0.f});
  backwards.accessor<float>("VEC3", std::vector<float>(6, 2.f));
  scene = backwards.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->animations[0].channels.at(0).times_s, (std::vector<float>{0, 1}));
}

}  // namespace
}  // namespace candela::test
