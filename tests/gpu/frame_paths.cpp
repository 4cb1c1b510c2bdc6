// Frames of nodes that go along paths: those of nodes that stand where the path is, whoever poses them.
#include "frame_fixture.h"
#include "instances_fixture.h"
#include "plan/posed_scene.h"
#include "scene/motion_files.h"

namespace candela::test::frame_paths {
class FramePaths : public FrameTest {
 protected:
  static std::string file(const std::string& name, const std::string& text) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string path =
        ::testing::TempDir() + fmt::format("candela_{}_{}_{}", info->test_suite_name(), info->name(), name);
    std::ofstream(path) << text;
    return path;
  }
  static void add_path(Job& job, const std::string& text) {
    auto path = parse_node_path("--path", text);
    ASSERT_TRUE(path) << path.error().text();
    job.paths.push_back(std::move(*path));
  }
  static bool has_pass(const FrameResult& frame, const std::string& name) {
    return std::ranges::any_of(frame.plan->passes, [&](const PlanPass& p) { return p.name == name; });
  }
};

constexpr const char* bent = "-1 0 0\n0 1 0.5\n1 0 -0.5\n0.5 -0.5 0\n";

// A square with a lamp on it, whose shadow moves too.
TEST_F(FramePaths, GiveTheFramesOfNodesThatStandThere) {
  const auto built = [](glm::dvec3 at) {
    GltfBuilder b = empty_scene();
    const int grey = add_material(b, diffuse_material(0.7, 0.7, 0.7));
    add_node(b, {{"mesh", add_square_mesh(b, 4, grey)}, {"translation", {0, 0, -2}}});
    add_light(b, {{"type", "point"}, {"intensity", 30}, {"range", 20}},
              {{"name", "Moved"}, {"mesh", add_square_mesh(b, 0.5f, grey)}, {"translation", {at.x, at.y, at.z}}});
    add_light(b, {{"type", "point"}, {"intensity", 20}, {"range", 20}}, {{"translation", {0.5, 0.5, 3}}});
    return b;
  };
  const std::string points = file("points.txt", bent), times = file("times.txt", "0 0\n1 2\n2 5\n");
  const auto read = read_points(points);
  ASSERT_TRUE(read);
  const Spline spline(*read, Spline::Ends::touch);
  Job moving = job_for(write(built({9, 9, 9})), 64, 48);
  look(moving, {0, 0, 5}, {0, 0, 0}, 50);
  moving.layers = {"depth", "shadow_local"};
  add_path(moving, "Moved=" + points + ",times=" + times);
  const auto session = open(moving);
  ASSERT_TRUE(session);
  for (const auto& [t, u] : {std::pair(-1.0, 0.0), {0.5, 1.0}, {1.5, 3.5}, {2.0, 5.0}, {7.0, 5.0}}) {
    Job still = moving;
    still.paths.clear();
    still.scene = write(built(spline.at(u)));
    const FrameResult frame = render(*session, t);
    const Images expected = images_of(still), got = images(frame);
    for (const Image& image : expected) EXPECT_TRUE(image == got[image.layer]) << image.layer << " at " << t;
  }
}

TEST_F(FramePaths, OfInstancesAreTheSameOnTheDeviceAsOnTheHost) {
  Crowd crowd(glm::dvec3(0), 70);
  crowd.json["nodes"][1]["name"] = "Mover";
  Job job = job_for(write(crowd), 96, 64);
  job.effects = "none";
  job.layers = {"depth", "normal", "object_id"};
  look(job, {0, 0.5, 2}, {0, 0, -4}, 60);
  add_path(job, "Mover=" + file("points.txt", "0 0.5 -4\n1 0.5 -5\n-1 0.3 -4\n") + ",along,closed");
  Job on_host = job;
  job.settings = {{"pose_items", "enabled", "1"}};
  on_host.settings = {{"pose_items", "enabled", "0"}};
  const auto device = open(job), host = open(on_host);
  ASSERT_TRUE(device && host);
  for (const double t : {0.0, 1.7, 40.0}) {
    const FrameResult a = render(*host, t), b = render(*device, t);
    EXPECT_TRUE(has_pass(b, "pose_items") && !has_pass(a, "pose_items"));
    for (const Image& image : images(a)) EXPECT_TRUE(image == images(b)[image.layer]) << image.layer << " at " << t;
  }
}

// A square at (1, 0.5, 0) a second, and the same seen by a camera that goes the other way.
TEST_F(FramePaths, MotionIsThatOfThePath) {
  constexpr double distance_m = 4, yfov_deg = 45;
  constexpr int width = 48, height = 32;
  const double px_a_metre = height / (2 * std::tan(yfov_deg / 2 * std::numbers::pi / 180) * distance_m);
  GltfBuilder b = empty_scene();
  use_materials(b);
  const int moved =
      add_node(b, {{"name", "Moved"}, {"mesh", add_square_mesh(b, 0.5f, add_material(b, unlit_material(1, 1, 1)))}});
  b.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", yfov_deg * std::numbers::pi / 180}, {"znear", 0.1}}}}};
  add_node(b, {{"camera", 0}, {"translation", {0, 0, distance_m}}});
  const std::string scene = write(b);
  // Evenly spaced points on a line, so that a span a second is even too.
  const std::string square = file("square.txt", "-2 -1 0\n-1 -0.5 0\n0 0 0\n1 0.5 0\n2 1 0\n"),
                    camera = file("camera.txt", "2 1 4\n1 0.5 4\n0 0 4\n-1 -0.5 4\n-2 -1 4\n");
  for (const std::string path : {"Moved=" + square + ",ends=plain", "camera=" + camera + ",ends=plain"}) {
    Job job = job_for(scene, width, height);
    job.layers = {"motion", "object_id"};
    job.motion_s = 0.1;
    add_path(job, path);
    const Images images = images_of(job, {}, 1);
    size_t seen = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (images["object_id"].at<uint32_t>(x, y) == uint32_t(moved)) {
          ++seen;
          const glm::dvec2 motion(images["motion"].at<glm::vec2>(x, y));
          EXPECT_LT(glm::length(motion - glm::dvec2(1, 0.5) * px_a_metre * 0.1), 3e-5) << path;
        }
    EXPECT_GT(seen, 60u) << path;
  }
}

// Read again in place: the frames of a session that was opened with what is there then.
TEST_F(FramePaths, ReadAgainGiveTheFramesOfANewSession) {
  GltfBuilder b = empty_scene();
  const int grey = add_material(b, diffuse_material(0.7, 0.7, 0.7));
  add_node(b, {{"mesh", add_square_mesh(b, 2, grey)}, {"translation", {0, 0, -1}}});
  add_light(b, {{"type", "point"}, {"intensity", 30}}, {{"name", "Lamp"}, {"translation", {0, 0, 2}}});
  Job job = job_for(write(b), 48, 32);
  look(job, {0, 0, 5}, {0, 0, 0});
  const std::string points = file("points.txt", bent);
  job.look = look_file(R"({"exposure": {"ev": 0}})");
  add_path(job, "light Lamp=" + points);
  const auto session = open(job);
  ASSERT_TRUE(session);
  const Images first = images(render(*session, 1));
  std::ofstream(points) << "0 0 1\n";
  std::ofstream(job.look) << R"({"exposure": {"ev": -1}, "sky": {"gradient": {}}})";
  const auto in_place = session->reread_look();
  ASSERT_TRUE(in_place) << in_place.error().text();
  EXPECT_TRUE(*in_place);
  const Images again = images(render(*session, 1)), anew = images_of(job, {}, 1);
  for (const Image& image : anew) EXPECT_TRUE(image == again[image.layer]) << image.layer;
  EXPECT_FALSE(again["beauty"] == first["beauty"]);
  // What is malformed changes nothing; what moves another node asks for another session.
  std::ofstream(points) << "0 0\n";
  EXPECT_FALSE(session->reread_look());
  const Images kept = images(render(*session, 1));
  for (const Image& image : again) EXPECT_TRUE(image == kept[image.layer]) << image.layer;
  std::ofstream(points) << "0 0 1\n";
  std::ofstream(job.look) << R"({"instances": [{"node": "Lamp", "file": "none.txt"}]})";
  const auto other = session->reread_look();
  ASSERT_TRUE(other) << other.error().text();
  EXPECT_FALSE(*other);
  session->reread_shaders();
  for (const Image& image : images(render(*session, 1))) EXPECT_TRUE(image == again[image.layer]) << image.layer;
}

}  // namespace candela::test::frame_paths
