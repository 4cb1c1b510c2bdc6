#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace candela::test::gltf_geometry {
namespace {

const MeshSection& section_of(const Expected<Scene>& scene) { return scene->meshes.at(0).sections.at(0); }

std::vector<float> line_of_points(int count) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) out.insert(out.end(), {float(i), float(i % 2), 0});
  return out;
}

struct ModeCase {
  int mode;
  Topology topology;
  std::vector<float> x;  // of the vertices in drawing order
};

// Five vertices with x = 0..4, drawn in every mode, with and without indices.
class GltfMode : public testing::TestWithParam<ModeCase> {};
TEST_P(GltfMode, BecomesAListInTheSpecificationsOrder) {
  const ModeCase& c = GetParam();
  for (const bool indexed : {false, true}) {
    GltfBuilder b;
    Json& primitive = b.primitive({{"POSITION", b.accessor<float>("VEC3", line_of_points(5))}}, c.mode);
    if (indexed) primitive["indices"] = b.accessor<uint8_t>("SCALAR", {0, 1, 2, 3, 4});
    const Expected<Scene> scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    const MeshSection& s = section_of(scene);
    EXPECT_EQ(s.topology, c.topology);
    std::vector<float> x;
    for (const uint32_t i : s.index) x.push_back(s.position[i].x);
    EXPECT_EQ(x, c.x) << "mode " << c.mode;
  }
}
INSTANTIATE_TEST_SUITE_P(All, GltfMode,
                         testing::Values(ModeCase{0, Topology::points, {0, 1, 2, 3, 4}},
                                         ModeCase{1, Topology::lines, {0, 1, 2, 3}},
                                         ModeCase{2, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4, 4, 0}},
                                         ModeCase{3, Topology::lines, {0, 1, 1, 2, 2, 3, 3, 4}},
                                         ModeCase{4, Topology::triangles, {0, 1, 2}},
                                         ModeCase{5, Topology::triangles, {0, 1, 2, 1, 3, 2, 2, 3, 4}},
                                         ModeCase{6, Topology::triangles, {1, 2, 0, 2, 3, 0, 3, 4, 0}}));

TEST(GltfGeometry, DropsVerticesThatNoIndexNames) {
  GltfBuilder b;
  b.primitive({{"POSITION", b.accessor<float>("VEC3", line_of_points(100))},
               {"NORMAL", b.accessor<float>("VEC3", std::vector<float>(300, 0.57735027f))}})["indices"] =
      b.accessor<uint16_t>("SCALAR", {90, 7, 50});
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const MeshSection& s = section_of(scene);
  ASSERT_EQ(s.position.size(), 3u);
  EXPECT_EQ(s.position[s.index[0]].x, 90);
  EXPECT_EQ(s.position[s.index[1]].x, 7);
  EXPECT_EQ(s.position[s.index[2]].x, 50);
}

TEST(GltfGeometry, RefusesIndicesOutOfRange) {
  for (const auto& [index, code] : {std::pair<uint8_t, const char*>{3, "ACCESSOR_INDEX_OOB"}}) {
    GltfBuilder b;
    b.primitive({{"POSITION", b.accessor<float>("VEC3", line_of_points(3))}})["indices"] =
        b.accessor<uint8_t>("SCALAR", {0, 1, index});
    const Expected<Scene> scene = b.load();
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().kind, ErrorKind::input);
    EXPECT_NE(scene.error().message.find(code), std::string::npos) << scene.error().text();
    EXPECT_EQ(scene.error().place, "test.glb: /meshes/0/primitives/0/indices");
  }
}

TEST(GltfGeometry, SparseWithAndWithoutABase) {
  for (const bool base : {true, false}) {
    GltfBuilder b;
    const int position = b.accessor<float>("VEC3", {0, 0, 5, 1, 0, 5, 0, 1, 5});
    const int indices = b.view<uint16_t>({2}), values = b.view<float>({0, 9, 7});
    Json& a = b.json["accessors"][size_t(position)];
    if (!base) a.erase("bufferView");
    a["sparse"] = {{"count", 1},
                   {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                   {"values", {{"bufferView", values}}}};
    b.primitive({{"POSITION", position}}, 0);
    const Expected<Scene> scene = b.load();
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(section_of(scene).position[2], glm::vec3(0, 9, 7));
    EXPECT_EQ(section_of(scene).position[1], base ? glm::vec3(1, 0, 5) : glm::vec3(0));
  }
}

TEST(GltfGeometry, SparseIndexOutOfRangeIsRefused) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", line_of_points(3));
  b.json["accessors"][size_t(position)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", b.view<uint16_t>({3})}, {"componentType", 5123}}},
      {"values", {{"bufferView", b.view<float>({0, 9, 7})}}}};
  b.primitive({{"POSITION", position}}, 0);
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("ACCESSOR_SPARSE_INDEX_OOB"), std::string::npos) << scene.error().text();
}

TEST(GltfGeometry, CountsOutOfProportionAreRefused) {
  GltfBuilder b;
  b.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 1000000000}});
  b.primitive({{"POSITION", 0}}, 0);
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::input);
}

TEST(GltfGeometry, ManyPrimitivesOfOneAccessorStayInProportion) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", line_of_points(9000));
  b.primitive({{"POSITION", position}}, 0);
  for (int i = 0; i < 4000; ++i) b.json["meshes"][0]["primitives"].push_back(b.json["meshes"][0]["primitives"][0]);
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("out of proportion"), std::string::npos) << scene.error().text();
}

TEST(GltfGeometry, QuantizedAttributesWithStrideAndTheLowestValueAtMinusOne) {
  GltfBuilder b;
  b.use("KHR_mesh_quantization", true);
  const int position = b.accessor<int16_t>("VEC3", {-32768, 32767, 0, 77, 16384, -32767, 0, 0, 77, 0, 0, 0});
  Json& a = b.json["accessors"][size_t(position)];
  a["normalized"] = true;
  a["count"] = 3;
  b.json["bufferViews"][0]["byteStride"] = 8;
  b.json["bufferViews"][0]["byteLength"] = 24;
  const int uv = b.accessor<uint8_t>("VEC2", {0, 255, 9, 9, 51, 102, 9, 9, 3, 4, 9, 9}, true);
  b.json["accessors"][size_t(uv)]["count"] = 3;
  b.json["bufferViews"].back()["byteStride"] = 4;
  const int plain = b.accessor<uint16_t>("VEC2", {500, 2, 3, 4, 5, 6});
  b.primitive({{"POSITION", position}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", plain}}, 0);
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const MeshSection& s = section_of(scene);
  EXPECT_EQ(s.position[0], glm::vec3(-1, 1, 0));
  EXPECT_FLOAT_EQ(s.position[1].x, 16384.f / 32767.f);
  EXPECT_EQ(s.position[1].y, -1);
  EXPECT_FLOAT_EQ(s.uv0[1].x, 0.2f);
  EXPECT_FLOAT_EQ(s.uv0[0].y, 1.f);
  EXPECT_EQ(s.uv1[0], glm::vec2(500, 2));
}

TEST(GltfGeometry, ColoursOfEveryKind) {
  const auto color = [](auto type, const std::string& kind, std::vector<double> values) {
    using T = decltype(type);
    GltfBuilder b;
    const int position = b.accessor<float>("VEC3", line_of_points(1));
    b.primitive(
        {{"POSITION", position},
         {"COLOR_0", b.accessor<T>(kind, std::vector<T>(values.begin(), values.end()), !std::is_same_v<T, float>)}},
        0);
    const Expected<Scene> scene = b.load();
    EXPECT_TRUE(scene) << scene.error().text();
    return scene ? section_of(scene).color.at(0) : glm::vec4(-1);
  };
  EXPECT_EQ(color(float(), "VEC3", {0.25, 0.5, 0.75}), glm::vec4(0.25, 0.5, 0.75, 1));
  EXPECT_EQ(color(float(), "VEC4", {0.25, 0.5, 0.75, 0.125}), glm::vec4(0.25, 0.5, 0.75, 0.125));
  EXPECT_EQ(color(uint8_t(), "VEC4", {0, 255, 51, 255}), glm::vec4(0, 1, 0.2f, 1));
  EXPECT_EQ(color(uint16_t(), "VEC4", {65535, 0, 13107, 0}), glm::vec4(1, 0, 0.2f, 0));
}

TEST(GltfGeometry, FlatNormalsWhereNoneAreGiven) {
  GltfBuilder b;
  b.triangle();
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  for (const glm::vec3& n : section_of(scene).normal) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  EXPECT_EQ(section_of(scene).normal.size(), 3u);
  EXPECT_TRUE(section_of(scene).tangent.empty());
}

TEST(GltfGeometry, WeightsSumToOneAndZeroWeightsFollowTheFirstJoint) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", line_of_points(3));
  b.primitive({{"POSITION", position},
               {"JOINTS_0", b.accessor<uint8_t>("VEC4", {1, 0, 0, 0, 1, 0, 9, 0, 1, 0, 0, 0})},
               {"WEIGHTS_0", b.accessor<float>("VEC4", {1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0})}});
  b.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, Json::object(), Json::object()};
  b.json["scenes"][0]["nodes"] = {0, 1, 2};
  b.json["skins"] = {{{"joints", {1, 2}}}};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  const MeshSection& s = section_of(scene);
  EXPECT_EQ(s.weights0[0], glm::vec4(0.5, 0.5, 0, 0));
  EXPECT_EQ(s.weights0[2], glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(s.joints0[2].x, 1);
  EXPECT_EQ(s.joints0[1].z, 0) << "a joint without weight need not exist";
  EXPECT_EQ(scene->skins[0].inverse_bind[1], glm::dmat4(1.0));
  EXPECT_TRUE(mentions(scene->warnings, "ACCESSOR_WEIGHTS_NON_NORMALIZED"));
}

TEST(GltfGeometry, JointsBeyondTheSkinAreRefused) {
  GltfBuilder b;
  b.primitive({{"POSITION", b.accessor<float>("VEC3", line_of_points(1))},
               {"JOINTS_0", b.accessor<uint8_t>("VEC4", {5, 0, 0, 0})},
               {"WEIGHTS_0", b.accessor<float>("VEC4", {1, 0, 0, 0})}},
              0);
  b.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, Json::object()};
  b.json["scenes"][0]["nodes"] = {0, 1};
  b.json["skins"] = {{{"joints", {1}}}};
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("ACCESSOR_JOINTS_INDEX_OOB"), std::string::npos) << scene.error().text();
}

TEST(GltfGeometry, MorphTargetsAndWeights) {
  GltfBuilder b;
  Json& p = b.primitive({{"POSITION", b.accessor<float>("VEC3", line_of_points(3))}}, 0);
  const int first = b.accessor<float>("VEC3", {1, 2, 3, 0, 0, 0, 0, 0, 0}),
            second = b.accessor<int8_t>("VEC3", {127, -128, 0, 9, 9, 9, 9, 9, 9}, true);
  b.use("KHR_mesh_quantization", true);
  b.json["bufferViews"].back()["byteStride"] = 4;
  b.json["accessors"][size_t(second)]["count"] = 2;
  p["targets"] = {{{"POSITION", first}}};
  b.json["meshes"][0]["weights"] = {0.5};
  b.json["nodes"][0]["weights"] = {0.25};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(section_of(scene).morph.at(0).position.at(0), glm::vec3(1, 2, 3));
  EXPECT_EQ(scene->meshes[0].default_weights, std::vector<float>{0.5f});
  EXPECT_EQ(scene->nodes[0].weights, std::vector<float>{0.25f});
  p["targets"] = {{{"POSITION", second}}};
  EXPECT_FALSE(b.load()) << "two deltas for three vertices";
}

TEST(GltfGeometry, NonFinitePositionsAreRefusedByName) {
  GltfBuilder b;
  const int position = b.accessor<float>("VEC3", line_of_points(3));
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(b.binary.data(), &infinity, 4);
  b.primitive({{"POSITION", position}});
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("ACCESSOR_INVALID_FLOAT"), std::string::npos) << scene.error().text();
}

}  // namespace
}  // namespace candela::test::gltf_geometry
