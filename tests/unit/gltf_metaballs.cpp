#include <gtest/gtest.h>

#include <limits>

#include "gltf_builder.h"
#include "scene/frame_data.h"

// CANDELA_metaballs: what is read, what comes out of a frame, and what is refused.
namespace candela {
namespace {

using test::GltfBuilder;
using test::Json;

struct Blob : GltfBuilder {
  Blob() {
    use("CANDELA_metaballs", true);
    use("KHR_animation_pointer");
    json["materials"] = {{{"name", "jelly"}}};
    json["nodes"] = {
        {{"name", "blob"}, {"translation", {10, 0, 0}}, {"children", {1, 2}}},
        {{"name", "first"}, {"translation", {-0.25, 0, 0}}},
        {{"name", "second"}, {"translation", {0.25, 0, 0}}},
    };
    json["nodes"][0]["extensions"]["CANDELA_metaballs"] = {
        {"threshold", 0.25},
        {"radius", 0.75},
        {"material", 0},
        {"balls", {{{"node", 1}}, {{"node", 2}, {"radius", 0.5}, {"strength", 2}}}}};
  }
  Json& extension() { return json["nodes"][0]["extensions"]["CANDELA_metaballs"]; }
};

FrameData frame_at(const Scene& scene, double time_s) {
  return make_frame_data(scene, evaluate_pose(scene, *choose_animations(scene, "all"), time_s), View{});
}

TEST(GltfMetaballs, AreReadWithTheirDefaults) {
  const Expected<Scene> scene = Blob().load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(scene->warnings.empty());
  ASSERT_EQ(scene->metaballs.size(), 1u);
  const Metaballs& body = scene->metaballs[0];
  EXPECT_EQ(body.threshold, 0.25f);
  ASSERT_EQ(body.balls.size(), 2u);
  EXPECT_EQ(body.balls[0].radius_m, 0.75f);
  EXPECT_EQ(body.balls[0].strength, 1);
  EXPECT_EQ(body.balls[1].radius_m, 0.5f);
  EXPECT_EQ(body.balls[1].strength, 2);
  EXPECT_EQ(body.cell_m, 0.75f / 8);
  const FrameData frame = frame_at(*scene, 0);
  ASSERT_EQ(frame.metaballs.size(), 1u);
  EXPECT_GT(frame.metaballs[0].chunks, 0u);
  EXPECT_EQ(frame.items.size(), frame.metaballs[0].chunks);
  EXPECT_EQ(frame.items[0].material, 0);
  EXPECT_EQ(frame.metaballs[0].balls[1].centre, glm::dvec3(0.25, 0, 0));
  // The larger ball's surface alone ends within its support, and the body about it.
  const DAabb bounds = world_bounds(*scene, evaluate_pose(*scene, {}, 0));
  EXPECT_GT(bounds.min.x, 9);
  EXPECT_LT(bounds.max.x, 10.75);
}

TEST(GltfMetaballs, NodesAndPointersMoveThem) {
  Blob b;
  const int input = b.accessor<float>("SCALAR", {0, 1});
  const auto drive = [&](Json target, const std::string& type, const std::vector<float>& values) {
    b.json["animations"].push_back({{"samplers", {{{"input", input}, {"output", b.accessor<float>(type, values)}}}},
                                    {"channels", {{{"sampler", 0}, {"target", std::move(target)}}}}});
  };
  const auto pointer = [](const std::string& to) {
    return Json{{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", to}}}}}};
  };
  drive({{"node", 1}, {"path", "translation"}}, "VEC3", {0, 0, 0, 0, 2, 0});
  drive(pointer("/nodes/0/extensions/CANDELA_metaballs/threshold"), "SCALAR", {0.25f, 0.75f});
  drive(pointer("/nodes/0/extensions/CANDELA_metaballs/balls/1/radius"), "SCALAR", {0.5f, 1.5f});
  drive(pointer("/nodes/0/extensions/CANDELA_metaballs/balls/1/strength"), "SCALAR", {2, 1});
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(scene->warnings.empty());
  const FrameData frame = frame_at(*scene, 0.5);
  const PosedMetaballs& body = frame.metaballs[0];
  EXPECT_EQ(body.balls[0].centre, glm::dvec3(0, 1, 0));
  EXPECT_EQ(body.threshold, 0.5);
  EXPECT_EQ(body.balls[1].radius_m, 1);
  EXPECT_EQ(body.balls[1].strength, 1.5);
}

TEST(GltfMetaballs, HiddenNodesTakeTheirBallsAway) {
  Blob b;
  b.use("KHR_node_visibility");
  b.json["nodes"][2]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(frame_at(*scene, 0).metaballs[0].balls[1].strength, 0);
  b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const Expected<Scene> hidden = b.load();
  ASSERT_TRUE(hidden);
  EXPECT_TRUE(frame_at(*hidden, 0).metaballs.empty());
}

void expect_refused(const Blob& b, const std::string& path) {
  const Expected<Scene> scene = b.load();
  ASSERT_FALSE(scene) << path;
  EXPECT_EQ(scene.error().kind, ErrorKind::input);
  EXPECT_NE(scene.error().text().find("test.glb"), std::string::npos) << scene.error().text();
  EXPECT_NE(scene.error().text().find("/nodes/0/extensions/CANDELA_metaballs" + path), std::string::npos)
      << scene.error().text();
}
void expect_refused(const char* key, const Json& value) {
  Blob b;
  b.extension()[key] = value;
  expect_refused(b, std::string("/") + key);
}

TEST(GltfMetaballs, WhatIsWrongIsRefusedWithItsPath) {
  expect_refused("threshold", -0.1);
  expect_refused("threshold", 1e7);
  expect_refused("threshold", "half");
  expect_refused("radius", 0);
  expect_refused("cell", -1);
  expect_refused("cell", 0);
  expect_refused("strength", 1e7);
  expect_refused("material", 1);
  expect_refused("balls", Json::array());
  expect_refused("noise", 3);
  Blob b;
  b.extension()["balls"][1]["radius"] = -1;
  expect_refused(b, "/balls/1/radius");
  b = Blob();
  b.extension()["balls"][1].erase("node");
  expect_refused(b, "/balls/1");
  b = Blob();
  b.extension()["balls"][1]["node"] = 7;
  expect_refused(b, "/balls/1/node");
  b = Blob();
  b.extension()["balls"][1]["node"] = 0;  // itself, which is not below it
  expect_refused(b, "/balls/1/node");
  b = Blob();
  b.extension()["noise"] = {{"amplitude", 1}};
  expect_refused(b, "/noise/amplitude");
  b = Blob();
  b.extension().erase("balls");
  expect_refused(b, "");
  b = Blob();
  b.triangle();
  b.json["nodes"][0]["mesh"] = 0;
  expect_refused(b, "");
  b = Blob();
  b.extension()["balls"] = std::vector<Json>(1025, {{"node", 1}});
  expect_refused(b, "/balls");
}

// Nodes without an inverse, and places that are no numbers, leave no surface and no NaN.
TEST(GltfMetaballs, BrokenTransformsLeaveNothing) {
  Blob b;
  b.json["nodes"][0]["scale"] = {0, 0, 0};
  const Expected<Scene> scene = b.load();
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(frame_at(*scene, 0).items.empty());
}

}  // namespace
}  // namespace candela
