// Paths and instances from files, in scenes as jobs load them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/files.h"
#include "plan/plan_frame.h"
#include "plan/posed_scene.h"
#include "plan/scene_motion.h"
#include "scene/moving_nodes.h"
#include "scene/scene_path.h"
#include "scene_pieces.h"

namespace candela::test::frame_scene_motion {
namespace fs = std::filesystem;

class SceneMotion : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("scene-motion-") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    GltfBuilder b = empty_scene();
    const int mesh = add_square_mesh(b, 0.5f, add_material(b, diffuse_material(1, 1, 1)));
    const int arm = add_node(b, {{"name", "Arm"}, {"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}});
    const int hand = add_node(b, {{"name", "Hand"}, {"mesh", mesh}, {"scale", {1, 3, 1}}});
    b.json["scenes"][0]["nodes"].erase(1);  // it hangs on the arm
    b.json["nodes"][size_t(arm)]["children"] = {hand};
    add_light(b, {{"type", "spot"}, {"name", "Lamp"}, {"spot", Json::object()}}, {{"name", "Post"}});
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
    add_node(b, {{"name", "Eye"}, {"camera", 0}, {"translation", {0, 0, 5}}});
    with_camera_ = write("scene.glb", b.glb());
    b.json.erase("cameras");
    b.json["nodes"].erase(b.json["nodes"].size() - 1);
    b.json["scenes"][0]["nodes"].erase(b.json["scenes"][0]["nodes"].size() - 1);
    without_camera_ = write("no-camera.glb", b.glb());
    line_ = write("line.txt", "0 0 0\n4 0 0\n8 0 0\n12 0 0\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, std::span<const std::byte> bytes) const {
    EXPECT_TRUE(write_file_atomically(folder_ / name, bytes));
    return (folder_ / name).string();
  }
  std::string write(const std::string& name, const std::string& text) const {
    return write(name, std::as_bytes(std::span(text)));
  }
  Job job(std::vector<std::string> paths, bool camera = true) const {
    Job job;
    job.scene = camera ? with_camera_ : without_camera_;
    job.width_px = 64, job.height_px = 36;
    for (const std::string& text : paths) {
      auto path = parse_node_path("--path", text);
      EXPECT_TRUE(path) << path.error().text();
      job.paths.push_back(std::move(*path));
    }
    return job;
  }
  static glm::dvec3 place_of(const Pose& pose, const Scene& scene, const std::string& name) {
    for (size_t n = 0; n < scene.nodes.size(); ++n)
      if (scene.nodes[n].name == name) return pose.world_from_node[n][3];
    ADD_FAILURE() << name;
    return glm::dvec3(0);
  }
  static glm::dvec3 axis_of(const Pose& pose, const Scene& scene, const std::string& name, int axis) {
    for (size_t n = 0; n < scene.nodes.size(); ++n)
      if (scene.nodes[n].name == name) return glm::normalize(glm::dvec3(pose.world_from_node[n][axis]));
    return glm::dvec3(0);
  }
  fs::path folder_;
  std::string with_camera_, without_camera_, line_;
};

TEST_F(SceneMotion, ANodeGoesInTheSpaceOfItsParent) {
  const Job asked = job({"Hand=" + line_ + ",ends=plain,seconds=2"});
  const auto scene = load_scene(asked);
  ASSERT_TRUE(scene) << scene.error().text();
  // One span of four points on a line: from 4 to 8 of the parent, evenly.
  for (const auto& [t, x] : {std::pair(-1.0, 4.0), {0.0, 4.0}, {0.5, 5.0}, {1.0, 6.0}, {2.0, 8.0}, {99.0, 8.0}})
    EXPECT_LT(glm::length(place_of(evaluate_pose(*scene, {}, t), *scene, "Hand") - glm::dvec3(10 + 2 * x, 0, 0)), 1e-12)
        << t;
  EXPECT_EQ(clips_end_s(*scene, {}), 2);
  const std::vector<bool> moving = moving_nodes(*scene, {});
  for (size_t n = 0; n < scene->nodes.size(); ++n) EXPECT_EQ(moving[n], scene->nodes[n].name == "Hand");
  // The file's content belongs to the picture's identity.
  EXPECT_NE(std::find(scene->files.begin(), scene->files.end(), line_), scene->files.end());
}

TEST_F(SceneMotion, WithoutPathsASceneHasNone) {
  const auto scene = load_scene(job({}));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->paths, nullptr);
  EXPECT_EQ(job_json(job({})).find("paths"), std::string::npos);
}

TEST_F(SceneMotion, TheCameraGoesThroughTheWorldOfTheFilesAxes) {
  for (const bool has_camera : {true, false})
    for (const std::string up : {"y", "z"}) {
      Job asked = job({"camera=" + write("up.txt", "0 0 1\n0 0 1\n") + ",look-at=0:5:1,up=0:0:1"}, has_camera);
      asked.up = up;
      const auto scene = load_scene(asked);
      ASSERT_TRUE(scene) << scene.error().text();
      const auto posed = pose_scene(*scene, asked, 0);
      ASSERT_TRUE(posed) << posed.error().text();
      const glm::dvec3 place = up == "z" ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
      const glm::dvec3 way = up == "z" ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
      EXPECT_LT(glm::length(posed->view.position - place), 1e-12) << up;
      const glm::dvec3 seen = glm::dmat3(posed->view.view_from_relative) * way;
      EXPECT_LT(glm::length(seen - glm::dvec3(0, 0, -1)), 1e-12) << up;
      // What is up of the file is up in the picture.
      const glm::dvec3 above = glm::dmat3(posed->view.view_from_relative) * place;
      EXPECT_LT(glm::length(above - glm::dvec3(0, 1, 0)), 1e-12) << up;
    }
}

// A film's cut: neither shutter nor motion reaches over it.
TEST_F(SceneMotion, ACameraCutsWhereItsPathJumps) {
  const std::string times = write("cut.txt", "0 0\n1 1\n1 2\n2 3\n");
  const std::string long_line = write("long.txt", "0 0 9\n1 0 9\n2 0 9\n3 0 9\n4 0 9\n5 0 9\n");
  const Job asked = job({"camera=" + long_line + ",ends=plain,times=" + times});
  const auto scene = load_scene(asked);
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(camera_cuts(*scene, asked), std::vector<double>{1});
  const auto x_at = [&](double t) { return pose_scene(*scene, asked, t)->view.position.x; };
  EXPECT_NEAR(x_at(1 - 1e-9), 2, 1e-8);
  EXPECT_DOUBLE_EQ(x_at(1), 3);
  const auto before = [&](double t) {
    return pose_before(*scene, asked, t, pose_scene(*scene, asked, t)->pose)->view.position.x;
  };
  ASSERT_GT(asked.motion_s, 0);
  EXPECT_DOUBLE_EQ(before(1), 3) << "the first picture after the cut";
  EXPECT_DOUBLE_EQ(before(1 + asked.motion_s / 2), 3);
  EXPECT_DOUBLE_EQ(before(1.5), x_at(1.5 - asked.motion_s));
  EXPECT_DOUBLE_EQ(before(1 - 1e-9), x_at(1 - 1e-9 - asked.motion_s));
  const auto [from, to] = open_shutter(1, 0.5, camera_cuts(*scene, asked));
  EXPECT_EQ(from, 1);
  EXPECT_EQ(to, 1.25);
  // So does what it looks at.
  const Job looking =
      job({"Hand=" + long_line + ",ends=plain,times=" + times, "camera=" + line_ + ",look_at_node=Hand"});
  const auto looked_at = load_scene(looking);
  ASSERT_TRUE(looked_at) << looked_at.error().text();
  EXPECT_EQ(camera_cuts(*looked_at, looking), std::vector<double>{1});
}

TEST_F(SceneMotion, ACameraThatTheFileLacksLooksAtTheMiddle) {
  const Job asked = job({"camera=" + write("at.txt", "0 0 7\n")}, false);
  const auto scene = load_scene(asked);
  ASSERT_TRUE(scene) << scene.error().text();
  const auto posed = pose_scene(*scene, asked, 0);
  ASSERT_TRUE(posed) << posed.error().text();
  const glm::dvec3 way = glm::normalize(glm::dvec3(10, 0, 0) - glm::dvec3(0, 0, 7));
  EXPECT_LT(glm::length(glm::dmat3(posed->view.view_from_relative) * way - glm::dvec3(0, 0, -1)), 1e-9);
  ASSERT_TRUE(scene->paths);
  EXPECT_NE(scene->paths->notes.at(0).find("looks at the middle"), std::string::npos);
}

TEST_F(SceneMotion, NodesLookAlongAtPointsAndAtEachOther) {
  const std::string rising = write("rising.txt", "0 0 0\n0 0 4\n0 0 8\n0 0 12\n");
  const auto scene = load_scene(job({"Hand=" + line_ + ",along", "light Lamp=" + rising + ",look_at_node=Hand",
                                     "camera=" + rising + ",look_at_node=Post"}));
  ASSERT_TRUE(scene) << scene.error().text();
  for (const double t : {0.0, 1.3, 2.5, 5.0}) {
    const Pose pose = evaluate_pose(*scene, {}, t);
    EXPECT_LT(glm::length(axis_of(pose, *scene, "Hand", 2) - glm::dvec3(1, 0, 0)), 1e-9) << t;
    const glm::dvec3 way = place_of(pose, *scene, "Hand") - place_of(pose, *scene, "Post");
    EXPECT_LT(glm::length(axis_of(pose, *scene, "Post", 2) + glm::normalize(way)), 1e-9) << t;
  }
  // Scale is kept, and nothing is mirrored.
  const Pose pose = evaluate_pose(*scene, {}, 1);
  for (size_t n = 0; n < scene->nodes.size(); ++n)
    if (scene->nodes[n].name == "Hand") {
      EXPECT_NEAR(glm::length(glm::dvec3(pose.world_from_node[n][1])), 6, 1e-9);
      EXPECT_GT(glm::determinant(glm::dmat3(pose.world_from_node[n])), 0);
    }
}

TEST_F(SceneMotion, ConstantSpeedGoesAsFarInEachSecond) {
  const std::string bent = write("bent.txt", "0 0 0\n1 0 0\n1 6 0\n2 6 1\n9 0 0\n");
  const auto scene = load_scene(job({"Post=" + bent + ",constant_speed,seconds=10"}));
  ASSERT_TRUE(scene) << scene.error().text();
  const ScenePath& path = scene->paths->paths.at(0);
  ASSERT_TRUE(path.length);
  const double whole = path.length->total_m();
  for (int i = 0; i < 10; ++i) {
    double way = 0;
    for (int k = 0; k < 2000; ++k)
      way += glm::length(path.at(i + (k + 1) / 2000.0).position - path.at(i + k / 2000.0).position);
    EXPECT_NEAR(way, whole / 10, 1e-6 * whole) << i;
  }
}

TEST_F(SceneMotion, MotionIsOfThePathAFrameBefore) {
  const Job asked = job({"Hand=" + line_ + ",ends=plain,seconds=2"});
  const auto scene = load_scene(asked);
  ASSERT_TRUE(scene) << scene.error().text();
  const auto now = pose_scene(*scene, asked, 1);
  ASSERT_TRUE(now);
  const auto before = pose_before(*scene, asked, 1, now->pose);
  ASSERT_TRUE(before) << before.error().text();
  const glm::dvec3 moved = place_of(now->pose, *scene, "Hand") - place_of(before->pose, *scene, "Hand");
  EXPECT_LT(glm::length(moved - glm::dvec3(2 * 2 / 24.0, 0, 0)), 1e-12);
}

TEST_F(SceneMotion, TheJobGoesBeforeTheLook) {
  write("near.txt", "1 0 0\n");
  const std::string look = write("scene.look.json", R"({"paths": [{"target": "node Hand", "points": "near.txt"},
      {"target": "node Post", "points": "near.txt"}], "instances": [{"node": "Hand", "file": "many.txt"}]})");
  write("many.txt", "1 1 1\n0 0 0\n0 0 0\n1 1 1 0 0 0 0 9 0\n");
  Job asked = job({"Hand=" + line_ + ",seconds=2"});
  asked.look = look;
  const auto scene = load_scene(asked);
  ASSERT_TRUE(scene) << scene.error().text();
  const Pose pose = evaluate_pose(*scene, {}, 9);
  EXPECT_EQ(place_of(pose, *scene, "Hand").x, 10 + 2 * 12);
  EXPECT_EQ(place_of(pose, *scene, "Post").x, 1);
  for (const Node& node : scene->nodes)
    EXPECT_EQ(node.instances ? node.instances->count : 0, node.name == "Hand" ? 2u : 0u);
}

TEST_F(SceneMotion, WhatCannotBeIsNamedAndNothingIsLoaded) {
  const auto error = [&](const Job& asked) {
    const auto scene = load_scene(asked);
    return scene ? std::string() : scene.error().text();
  };
  EXPECT_NE(error(job({"Hnad=" + line_})).find("unknown node 'Hnad'; did you mean 'Hand'?"), std::string::npos);
  EXPECT_NE(error(job({"light Lmap=" + line_})).find("unknown light 'Lmap'; did you mean 'Lamp'?"), std::string::npos);
  EXPECT_NE(error(job({"Hand=" + line_, "Hand=" + line_})).find("node Hand has another path already"),
            std::string::npos);
  EXPECT_NE(error(job({"Hand=" + write("three.txt", "0 0 0\n1 0 0\n2 0 0\n") + ",ends=plain"})).find("needs 4"),
            std::string::npos);
  EXPECT_NE(error(job({"Hand=" + write("bad.txt", "0 0 0\n1 0\n")})).find("bad.txt:2: "), std::string::npos);
  EXPECT_NE(error(job({"Hand=" + line_ + ",times=" + write("t.txt", "0 0\n1 1\n0.5 2\n")})).find("t.txt:3: "),
            std::string::npos);
  Job many = job({});
  many.instances.push_back({.node = "Post", .file = line_});
  EXPECT_NE(error(many).find("node 'Post' has no mesh"), std::string::npos);
  // A look names files of its own folder alone.
  Job outside = job({});
  outside.look = write("a.look.json", R"({"paths": [{"target": "camera", "points": "../else.txt"}]})");
  EXPECT_NE(error(outside).find("a.look.json: /paths/0: "), std::string::npos) << error(outside);
}

TEST_F(SceneMotion, IdentityIsOfContentsAndNotOfNames) {
  Job a = job({"Hand=" + line_ + ",times=" + line_}), b = job({"Hand=else.txt,times=other.txt"});
  EXPECT_EQ(frame_identity(a, "content", "device", 0), frame_identity(b, "content", "device", 0));
  b.paths[0].closed = true;
  EXPECT_NE(frame_identity(a, "content", "device", 0), frame_identity(b, "content", "device", 0));
  const auto again = job_from_json(job_json(a));
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(job_json(*again), job_json(a));
}

}  // namespace candela::test::frame_scene_motion
