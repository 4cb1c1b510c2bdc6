// The layer motion against what is known of things that move, of cameras that do, and of what stands still.
#include <numbers>

#include "frame_fixture.h"

namespace candela::test::frame_motion {
namespace {

constexpr int width = 48, height = 32;
constexpr double distance_m = 4, yfov_deg = 45;
const double px_a_metre = height / (2 * std::tan(yfov_deg / 2 * std::numbers::pi / 180) * distance_m);

// Linear from the first value at 0 s to the second at 1 s.
void animate(GltfBuilder& b, int node, const char* path, const std::string& type, const std::vector<float>& from,
             const std::vector<float>& to) {
  std::vector<float> values = from;
  values.insert(values.end(), to.begin(), to.end());
  const int input = b.accessor<float>("SCALAR", {0, 1}), output = b.accessor<float>(type, values);
  b.json["animations"].push_back({{"samplers", {{{"input", input}, {"output", output}}}},
                                  {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
}

GltfBuilder with_materials() {
  GltfBuilder b = empty_scene();
  use_materials(b);
  return b;
}
int add_square(GltfBuilder& b, float half, glm::dvec3 at) {
  return add_node(b, {{"mesh", add_square_mesh(b, half, add_material(b, unlit_material(1, 1, 1)))},
                      {"translation", {at.x, at.y, at.z}}});
}

}  // namespace

class FrameMotion : public FrameTest {
 protected:
  static Job job_of(const std::string& file) {
    Job job = job_for(file, width, height);
    look(job, {0, 0, distance_m}, {0, 0, 0}, yfov_deg);
    job.layers = {"motion", "object_id"};
    return job;
  }
  static glm::vec2 at(const Images& images, int x, int y) { return images["motion"].at<glm::vec2>(x, y); }
  // Motion of every pixel that shows the node is what `expected` says of it; elsewhere it is exactly 0.
  static void expect_motion(const Images& images, uint32_t node, glm::dvec2 expected, size_t least) {
    size_t seen = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (images["object_id"].at<uint32_t>(x, y) != node) {
          ASSERT_EQ(at(images, x, y), glm::vec2(0)) << x << " " << y;
          continue;
        }
        ++seen;
        ASSERT_LT(glm::length(glm::dvec2(at(images, x, y)) - expected), 2e-5) << x << " " << y;
      }
    EXPECT_GE(seen, least);
  }
  static bool holds(const FrameResult& result, const std::string& what) {
    return std::ranges::any_of(result.plan->resources,
                               [&](const PlanResource& r) { return r.name().find(what) != std::string::npos; });
  }
};

// A square that moves by (1, 0.5, 0) a second before one that stands still, at two rates.
TEST_F(FrameMotion, OfAMovingNode) {
  GltfBuilder b = with_materials();
  add_square(b, 1.5, {0, 0, -1});
  const int moving = add_square(b, 0.5, {0, 0, 0});
  animate(b, moving, "translation", "VEC3", {-0.5, 0, 0}, {0.5, 0.5, 0});
  Job job = job_of(write(b));
  for (const double rate : {24.0, 10.0}) {
    job.motion_s = 1 / rate;
    expect_motion(images_of(job, {}, 0.5), uint32_t(moving), glm::dvec2(1, 0.5) * px_a_metre / rate, 60);
  }
  // Before the first key and after the last nothing moves; the first frame has no frame before it that differs.
  for (const double time_s : {-1.0, 0.0, 1.5}) expect_motion(images_of(job, {}, time_s), uint32_t(moving), {}, 60);
}

// Each vertex is moved by a morph target, or by a joint, as the node was above.
TEST_F(FrameMotion, OfMorphsAndSkins) {
  for (const bool skinned : {false, true}) {
    GltfBuilder b = with_materials();
    const int square = add_square(b, 0.5, {0, 0, 0});
    Json& primitive = b.json["meshes"].back()["primitives"][0];
    if (skinned) {
      primitive["attributes"]["JOINTS_0"] = b.accessor<uint8_t>("VEC4", std::vector<uint8_t>(16, 0));
      primitive["attributes"]["WEIGHTS_0"] =
          b.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
      const int joint = add_node(b, Json::object());
      b.json["skins"] = {{{"joints", {joint}}}};
      b.json["nodes"][size_t(square)]["skin"] = 0;
      animate(b, joint, "translation", "VEC3", {-0.5, 0, 0}, {0.5, 0.5, 0});
    } else {
      std::vector<float> offsets;
      for (int v = 0; v < 4; ++v) offsets.insert(offsets.end(), {1, 0.5, 0});
      primitive["targets"] = {{{"POSITION", b.accessor<float>("VEC3", offsets)}}};
      animate(b, square, "weights", "SCALAR", {-0.5}, {0.5});
    }
    const auto session = open(job_of(write(b)));
    const FrameResult moving = render(*session, 0.5);
    expect_motion(images(moving), uint32_t(square), glm::dvec2(1, 0.5) * px_a_metre / 24.0, 60);
    EXPECT_TRUE(holds(moving, "frame.motion")) << skinned;
    const FrameResult still = render(*session, 2);
    expect_motion(images(still), uint32_t(square), {}, 60);
    EXPECT_FALSE(holds(still, "frame.motion")) << skinned;
    for (const PlanPass& pass : still.plan->passes) EXPECT_NE(pass.name, "deform.before");
  }
}

// A camera that turns about the vertical and sinks: each pixel's ray is followed into the camera of the frame before.
TEST_F(FrameMotion, OfACamera) {
  GltfBuilder b = with_materials();
  add_square(b, 6, {0, 0, 0});
  b.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", yfov_deg * std::numbers::pi / 180}, {"znear", 0.1}}}}};
  const int camera = add_node(b, {{"camera", 0}});
  const double turn = 0.4, sink = -0.6;  // a second
  animate(b, camera, "rotation", "VEC4", {0, 0, 0, 1}, {0, float(std::sin(turn / 2)), 0, float(std::cos(turn / 2))});
  animate(b, camera, "translation", "VEC3", {0, 0, float(distance_m)}, {0, float(sink), float(distance_m)});
  Job job = job_for(write(b), width, height);
  job.layers = {"motion"};
  const double time_s = 0.75, tan_y = std::tan(yfov_deg / 2 * std::numbers::pi / 180), tan_x = tan_y * width / height;
  const auto camera_at = [&](double t) {
    return std::pair(glm::dvec3(0, sink * t, distance_m), glm::angleAxis(turn * t, glm::dvec3(0, 1, 0)));
  };
  const auto [eye, axes] = camera_at(time_s);
  const auto [eye_before, axes_before] = camera_at(time_s - 1 / 24.0);
  const Images seen = images_of(job, {}, time_s);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec2 ndc(2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height);
      const glm::dvec3 ray = axes * glm::dvec3(ndc.x * tan_x, ndc.y * tan_y, -1);
      const glm::dvec3 point = eye - ray * (eye.z / ray.z);
      const glm::dvec3 before = glm::inverse(axes_before) * (point - eye_before);
      const glm::dvec2 ndc_before = glm::dvec2(before.x / tan_x, before.y / tan_y) / -before.z;
      const glm::dvec2 expected = (ndc - ndc_before) * 0.5 * glm::dvec2(width, height);
      ASSERT_GT(glm::length(expected), 0.2);
      ASSERT_LT(glm::length(glm::dvec2(at(seen, x, y)) - expected), 2e-4) << x << " " << y;
    }
}

// The camera backs off through a wall: what was behind it has no place, and is said to stand still.
TEST_F(FrameMotion, FromBehindTheCameraIsNothing) {
  GltfBuilder b = with_materials();
  const int wall = add_square(b, 6, {0, 0, 0});
  b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.01}}}}};
  const int camera = add_node(b, {{"camera", 0}});
  animate(b, camera, "translation", "VEC3", {0, 0, -5}, {0, 0, 5});
  Job job = job_for(write(b), width, height);
  job.layers = {"motion", "object_id"};
  expect_motion(images_of(job, {}, 0.5 + 0.5 / 24), uint32_t(wall), {}, width * height);
  const Images later = images_of(job, {}, 0.5 + 1.5 / 24);
  EXPECT_GT(glm::length(at(later, 0, 0)), 1);
  for (const float v : later["motion"].values<float>()) ASSERT_TRUE(std::isfinite(v));
}

// Seen by a camera that stands still, a still scene has no time before, and neither has a frame that does not ask.
TEST_F(FrameMotion, NothingMovesForNothing) {
  GltfBuilder b = with_materials();
  const int moving = add_square(b, 0.5, {0, 0, 0});
  animate(b, moving, "translation", "VEC3", {-0.5, 0, 0}, {0.5, 0.5, 0});
  Job job = job_of(write(b));
  job.animation = "none";
  const auto session = open(job);
  const FrameResult still = render(*session, 0.5);
  expect_motion(images(still), uint32_t(moving), {}, 60);
  EXPECT_FALSE(holds(still, "frame.motion"));
  EXPECT_FALSE(holds(still, "motion.z"));
  job.animation = "all";
  const Images with = images_of(job, {}, 0.5);
  job.layers.clear();
  const auto without = open(job);
  const FrameResult plain = render(*without, 0.5);
  EXPECT_FALSE(holds(plain, "motion"));
  EXPECT_EQ(images(plain)["beauty"], with["beauty"]);
}

// A square that jumps here from so far off that its place in the picture was no float, in the middle of the way or at
// its end: infinities less infinities are no motion, and what floats reach is said.
TEST_F(FrameMotion, FromBeyondFloatsIsNothing) {
  for (const float far_m : {1e30f, 1e38f, 3e38f}) {
    GltfBuilder b = with_materials();
    const int square = add_square(b, 0.5, {0, 0, 0});
    animate(b, square, "translation", "VEC3", {far_m, -far_m, 0}, {0, 0, 0});
    b.json["animations"].back()["samplers"][0]["interpolation"] = "STEP";
    Job job = job_of(write(b));
    for (const glm::dvec3 eye : {glm::dvec3(0, 0, distance_m), glm::dvec3(distance_m, 0, distance_m)}) {
      look(job, eye, {0, 0, 0}, yfov_deg);
      const Images seen = images_of(job, {}, 1 + 0.5 * job.motion_s);
      size_t of_square = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          ASSERT_TRUE(std::isfinite(at(seen, x, y).x) && std::isfinite(at(seen, x, y).y))
              << far_m << " " << x << " " << y;
          if (seen["object_id"].at<uint32_t>(x, y) != uint32_t(square)) continue;
          ++of_square;
          if (eye.x > 0) continue;  // of a turned camera it was beside or behind: finite is all that is known
          const glm::dvec2 expected = far_m < 1e37f ? glm::dvec2(-far_m, far_m) * px_a_metre : glm::dvec2(0);
          ASSERT_LE(glm::length(glm::dvec2(at(seen, x, y)) - expected), 1e-5 * glm::length(expected)) << far_m;
        }
      EXPECT_GE(of_square, 30u) << far_m;
    }
  }
}

// What the mask cuts away shows the motion behind it.
TEST_F(FrameMotion, SeesThroughMasks) {
  GltfBuilder b = with_materials();
  const int behind = add_square(b, 1.5, {0, 0, 0});
  Json masked = unlit_material(1, 1, 1, 0.3);
  masked["alphaMode"] = "MASK";
  const int cut = add_node(b, {{"mesh", add_square_mesh(b, 0.5, add_material(b, masked))}, {"translation", {0, 0, 1}}});
  animate(b, cut, "translation", "VEC3", {-0.5, 0, 1}, {0.5, 0, 1});
  const Images images = images_of(job_of(write(b)), {}, 0.5);
  expect_motion(images, uint32_t(behind), {}, 300);
}

}  // namespace candela::test::frame_motion
