// What is mended in files and drawn (gltf/repair.h), each with its warning; docs/using/inputs.md has the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "gltf_builder.h"
#include "scene/pose.h"

namespace candela::test {
namespace {

bool warns(const Scene& scene, const std::string& text) {
  return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(text) != std::string::npos; });
}
Scene loaded(const GltfBuilder& b) {
  Expected<Scene> scene = b.load();
  EXPECT_TRUE(scene) << scene.error().text();
  return scene ? std::move(*scene) : Scene{};
}
GltfBuilder triangle_file() {
  GltfBuilder b;
  b.triangle();
  return b;
}

TEST(GltfRepair, NodesAreDrawnOnceUnderOneParent) {
  GltfBuilder b = triangle_file();
  b.json["scenes"][0]["nodes"] = {0, 0, 2};
  b.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}, {{"children", {1}}}, {{"children", {1}}}};
  Scene scene = loaded(b);
  EXPECT_EQ(std::ranges::count(scene.order, 0), 1);
  EXPECT_TRUE(warns(scene, "/scenes/0/nodes/1: node 0 is listed twice"));
  EXPECT_EQ(scene.nodes[1].parent, 2);
  EXPECT_TRUE(warns(scene, "/nodes/3/children/0: node 1 already has the parent 2"));
  // A root that is a child stands as a root.
  b.json["scenes"][0]["nodes"] = {1, 2};
  scene = loaded(b);
  EXPECT_EQ(scene.nodes[1].parent, -1);
  EXPECT_EQ(std::ranges::count(scene.order, 1), 1);
  EXPECT_TRUE(warns(scene, "SCENE_NON_ROOT_NODE"));
}

TEST(GltfRepair, MatricesGoBeforeAndZeroQuaternionsAreNone) {
  GltfBuilder b = triangle_file();
  b.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  b.json["nodes"][0]["translation"] = {1, 1, 1};
  const Scene matrix = loaded(b);
  EXPECT_EQ(evaluate_pose(matrix, {}, 0).world_from_node[0][3], glm::dvec4(5, 6, 7, 1));
  EXPECT_TRUE(warns(matrix, "NODE_MATRIX_TRS"));
  b = triangle_file();
  b.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
  const Scene rotation = loaded(b);
  EXPECT_EQ(evaluate_pose(rotation, {}, 0).world_from_node[0], glm::dmat4(1));
  EXPECT_TRUE(warns(rotation, "ROTATION_NON_UNIT"));
}

TEST(GltfRepair, LightsGetWhatTheSpecificationSays) {
  GltfBuilder b = triangle_file();
  b.use("KHR_lights_punctual");
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"range", 0}},
      {{"type", "spot"}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.4}}}}};
  for (int light = 0; light < 3; ++light) {
    b.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
    b.json["scenes"][0]["nodes"].push_back(light + 1);
  }
  const Scene scene = loaded(b);
  EXPECT_TRUE(std::isinf(scene.lights[0].range_m));
  EXPECT_FLOAT_EQ(scene.lights[1].outer_cone_rad, 0.78539816f);
  EXPECT_EQ(scene.lights[2].inner_cone_rad, scene.lights[2].outer_cone_rad);
  EXPECT_FLOAT_EQ(scene.lights[2].outer_cone_rad, 0.4f);
  for (const char* code : {"lights/0/range", "UNDEFINED_PROPERTY", "lights/2/spot"}) EXPECT_TRUE(warns(scene, code));
}

TEST(GltfRepair, WholeNumbersAreNormalized) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int color = b.accessor<uint8_t>("VEC4", {255, 0, 51, 255, 255, 0, 51, 255, 255, 0, 51, 255});
  const int uv = b.accessor<uint16_t>("VEC2", {65535, 0, 65535, 0, 65535, 0});
  b.primitive({{"POSITION", position}, {"COLOR_0", color}, {"TEXCOORD_0", uv}});
  const Scene scene = loaded(b);
  const MeshSection& section = scene.meshes[0].sections.at(0);
  EXPECT_EQ(section.color.at(0), glm::vec4(1, 0, 0.2f, 1));
  EXPECT_EQ(section.uv0.at(0), glm::vec2(1, 0));
  EXPECT_TRUE(warns(scene, "COLOR_0: whole numbers that are not normalized"));
}

TEST(GltfRepair, ColorsWithoutAComponentTypeAreAnError) {
  GltfBuilder b = triangle_file();
  const int colors = b.accessor<uint8_t>("VEC4", std::vector<uint8_t>(12, 255));
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors;
  b.json["accessors"][size_t(colors)].erase("componentType");
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().text().find("componentType"), std::string::npos) << scene.error().text();
}

TEST(GltfRepair, PrimitivesWithoutElementsAreLeftOut) {
  GltfBuilder b = triangle_file();
  b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  const int none = b.accessor<uint8_t>("SCALAR", {0, 1, 2});
  b.json["accessors"][none]["count"] = 0;
  b.json["meshes"][0]["primitives"][1]["indices"] = none;
  b.json["meshes"][0]["primitives"].push_back({{"attributes", Json::object()}});
  const Scene scene = loaded(b);
  EXPECT_EQ(scene.meshes[0].sections.size(), 1u);
  EXPECT_TRUE(warns(scene, "/meshes/0/primitives/1/indices"));
}

// The triangle that uses the restart value is left out.
TEST(GltfRepair, RestartValuesLeaveOutATriangle) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  b.primitive({{"POSITION", position}})["indices"] = b.accessor<uint8_t>("SCALAR", {0, 1, 2, 1, 3, 255});
  const Scene scene = loaded(b);
  EXPECT_EQ(scene.meshes[0].sections.at(0).index, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_TRUE(warns(scene, "ACCESSOR_INDEX_PRIMITIVE_RESTART"));
}

TEST(GltfRepair, KeysAreSortedWithTheirValues) {
  GltfBuilder b = triangle_file();
  const int input = b.accessor<float>("SCALAR", {0, 2, 1});
  const int output = b.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0, 1, 0, 0});
  b.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const Scene scene = loaded(b);
  const AnimationChannel& channel = scene.animations[0].channels.at(0);
  EXPECT_EQ(channel.times_s, (std::vector<float>{0, 1, 2}));
  EXPECT_EQ(channel.values, (std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}));
  EXPECT_EQ(scene.animations[0].end_s, 2);
  EXPECT_EQ(evaluate_pose(scene, {{0}}, 1.5).world_from_node[0][3].x, 1.5);
}

TEST(GltfRepair, OneCubicKeyIsAConstant) {
  GltfBuilder b = triangle_file();
  const int input = b.accessor<float>("SCALAR", {1});
  const int output = b.accessor<float>("VEC3", {9, 9, 9, 3, 0, 0, 9, 9, 9});
  b.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}, {"interpolation", "CUBICSPLINE"}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const Scene scene = loaded(b);
  for (const double t : {0.0, 1.0, 7.0}) EXPECT_EQ(evaluate_pose(scene, {{0}}, t).world_from_node[0][3].x, 3) << t;
}

// A texture that is not there is the checker; two of any sets of coordinates are read.
TEST(GltfRepair, TexturesAndTheirCoordinates) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int uv0 = b.accessor<float>("VEC2", {0, 0, 0, 0, 0, 0}), uv2 = b.accessor<float>("VEC2", {1, 2, 3, 4, 5, 6});
  Json& primitive =
      b.primitive({{"POSITION", position}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv0}, {"TEXCOORD_2", uv2}});
  primitive["material"] = 0;
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 7}, {"texCoord", 2}}}}}}};
  const Scene scene = loaded(b);
  EXPECT_TRUE(warns(scene, "baseColorTexture/index: unresolved reference: 7"));
  const TextureSlot& slot = scene.materials[0].base_color_texture;
  ASSERT_GE(slot.image, 0);
  EXPECT_TRUE(scene.images[size_t(slot.image)].encoded.empty());
  EXPECT_EQ(slot.uv_set, 0);
  EXPECT_EQ(scene.meshes[0].sections.at(0).uv0.at(2), glm::vec2(5, 6));
}

TEST(GltfRepair, ScaleOfCamerasAndLightsDoesNotCount) {
  GltfBuilder b = triangle_file();
  b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
  b.json["nodes"] = {{{"mesh", 0}},
                     {{"camera", 0}, {"scale", {-1, -1, -1}}, {"rotation", {0, 0.6, 0, 0.8}}},
                     {{"camera", 0}, {"rotation", {0, 0.6, 0, 0.8}}},
                     {{"camera", 0}, {"scale", {0, 0, 0}}, {"rotation", {0, 0.6, 0, 0.8}}}};
  b.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Pose pose = evaluate_pose(loaded(b), {}, 0);
  EXPECT_EQ(pose.world_from_node[1], pose.world_from_node[2]);
  EXPECT_EQ(pose.world_from_node[3], pose.world_from_node[2]);
}

// What is wrong with parts that the shown scene cannot reach is a warning.
TEST(GltfRepair, UnusedPartsAreNotLookedAt) {
  GltfBuilder b = triangle_file();
  b.use("KHR_lights_punctual");
  b.json["scenes"].push_back({{"nodes", {1}}});
  b.json["nodes"].push_back({{"mesh", 1}, {"camera", 5}});
  b.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 99}}}}}}});
  // The checks find the first two, the reader the third.
  b.json["materials"] = {{{"alphaMode", 7}}, {{"pbrMetallicRoughness", {{"roughnessFactor", "all"}}}}, {{"name", 7}}};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "lamp"}}};
  const Scene scene = loaded(b);
  EXPECT_EQ(scene.meshes[0].sections.size(), 1u);
  EXPECT_TRUE(warns(scene, "the scene does not use it"));
  for (const int used : {1, 2}) {
    b.json["meshes"][0]["primitives"][0]["material"] = used;
    EXPECT_FALSE(b.load());
  }
}

// Animations that nobody plays are no reason to refuse a file, whether the checks or the reader find them broken.
TEST(GltfRepair, AnimationsThatDoNotPlayAreNotLookedAt) {
  for (const bool by_reader : {false, true}) {
    GltfBuilder b = triangle_file();
    const int input = b.accessor<float>("SCALAR", {0, std::numeric_limits<float>::quiet_NaN()});
    const int output = b.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0});
    b.json["animations"] = {{{"samplers", {{{"input", input}, {"output", by_reader ? output : 77}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    EXPECT_FALSE(b.load());
    const Expected<Scene> still = b.load({LoadFor::raster, "", false});
    ASSERT_TRUE(still) << still.error().text();
    ASSERT_EQ(still->animations.size(), 1u);
    EXPECT_TRUE(still->animations[0].channels.empty());
    EXPECT_FALSE(still->warnings.empty());
  }
}

// Values of `extras` are passed over, however deep; what stands behind them is read.
TEST(GltfRepair, ExtrasArePassedOver) {
  const std::string depth = std::string(100000, '[') + std::string(100000, ']');
  const std::string text = R"({"extras": )" + depth + R"(, "asset": {"version": "2.0", "extras": 5, "generator": "g"},
    "nodes": [{"extras": {"a": {"a": 1, "a": 2}}, "name": "n"}], "scenes": [{"nodes": [0], "extras": []}], "scene": 0})";
  const Expected<Scene> scene = load_gltf_from_memory(std::as_bytes(std::span(text)), "deep.gltf", "");
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->nodes.at(0).name, "n");
  const std::string broken = R"({"extras": )" + depth + "]";
  EXPECT_FALSE(load_gltf_from_memory(std::as_bytes(std::span(broken)), "deep.gltf", ""));
}

TEST(GltfRepair, VersionsOfThreeNumbersAreRead) {
  GltfBuilder b = triangle_file();
  b.json["asset"]["version"] = "2.0.1";
  EXPECT_TRUE(warns(loaded(b), "'2.0.1' is not MAJOR.MINOR; it is read as 2.0"));
}

// A file is found under the name that was meant: with / for \, or as it is written.
TEST(GltfRepair, UrisGetASecondTry) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "candela_gltf_repair_uris";
  std::filesystem::create_directories(folder / "sub");
  for (const char* name : {"sub/a.bin", "50%.bin", "a%20b.bin"}) std::ofstream(folder / name) << std::string(36, '\0');
  for (const char* uri : {"sub\\\\a.bin", "50%.bin", "a%20b.bin"}) {
    std::ofstream(folder / "s.gltf") << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0],
      "max": [0, 0, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "buffers": [{"byteLength": 36, "uri": ")"
                                     << uri << "\"}]}";
    const Expected<Scene> scene = load_gltf(folder / "s.gltf");
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_TRUE(warns(*scene, "is taken for")) << uri;
  }
}

}  // namespace
}  // namespace candela::test
