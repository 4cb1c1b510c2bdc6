// What rays meet by the device's own trees (bvh.traversal), against the trees in shaders.
#include "frame_fixture.h"
#include "gpu/device_select.h"
#include "plan/frame_rays.h"

namespace candela::test::frame_traversal {

class Traversal : public FrameTest {
 protected:
  static Job drawn(const std::string& file) {
    Job job = job_for(file, 64, 36);
    job.technique = "ray";
    job.effects = "none";
    return job;
  }
  static Job by(Job job, const std::string& traversal) {
    job.settings.push_back({"bvh", "traversal", traversal});
    return job;
  }
  // Those that the device has.
  static std::vector<std::string> ways() {
    const auto session = open(drawn(scene("unlit-box")));
    if (!session) return {};
    const gpu::RayExtensions has = session->device().info().rays;
    std::vector<std::string> names;
    if (has.queries) names.push_back("query");
    if (has.pipelines) names.push_back("pipeline");
    return names;
  }
  // Where rays pass edges, the device may name the neighbour, or neither.
  static void expect_same(const Images& a, const Images& b, const std::string& name) {
    ASSERT_EQ(a.size(), b.size()) << name;
    for (size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a.at(i).bytes.size(), b.at(i).bytes.size()) << name;
      const size_t pixels = a.at(i).pixels(), pixel_bytes = a.at(i).bytes.size() / pixels;
      size_t differing = 0;
      for (size_t p = 0; p < pixels; ++p)
        differing += std::memcmp(a.at(i).bytes.data() + p * pixel_bytes, b.at(i).bytes.data() + p * pixel_bytes,
                                 pixel_bytes) != 0;
      EXPECT_LE(differing, pixels / 500) << name << " " << a.at(i).layer;
    }
  }
  // Two triangles, one behind the other and seen from its back, with holes where a vertex's alpha is below the cutoff.
  static std::string two_triangles(bool double_sided) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    for (const bool front : {true, false}) {
      const float z = front ? 0.0f : -1.0f;
      Json& p = b.primitive({{"POSITION", b.accessor<float>("VEC3", {-1, -1, z, 1, -1, z, 0, 1, z})},
                             {"COLOR_0", b.accessor<float>("VEC4", {1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 0.8f})}});
      p["indices"] =
          b.accessor<uint16_t>("SCALAR", front ? std::vector<uint16_t>{0, 1, 2} : std::vector<uint16_t>{0, 2, 1});
      Json material = unlit_material(0.5, front ? 0.8 : 0.2, 0.5);
      material["doubleSided"] = double_sided;
      if (front) material["alphaMode"] = "MASK";
      p["material"] = add_material(b, material);
      add_node(b, {{"mesh", int(b.json["meshes"].size()) - 1}});
    }
    return write(b);
  }
};

TEST_F(Traversal, NamesWhatTheTreesName) {
  const std::vector<std::string> names = ways();
  if (names.empty()) GTEST_SKIP() << "the device has neither ray queries nor pipelines of rays";
  for (const char* name : {"spheres", "alpha", "orthographic"}) {
    Job job = drawn(scene(name));
    const Images truth = images_of(job);
    for (const std::string& way : names) expect_same(truth, images_of(by(job, way)), std::string(name) + " " + way);
  }
}

TEST_F(Traversal, AsksOfSidesAndHoles) {
  for (const bool double_sided : {false, true}) {
    Job job = drawn(two_triangles(double_sided));
    look(job, {0, 0, 3}, {0, 0, 0});
    const Images truth = images_of(job);
    for (const std::string& way : ways()) {
      const Images seen = images_of(by(job, way));
      expect_same(truth, seen, way);
      const auto alpha = [&](int x, int y) { return seen["beauty"].at<glm::vec4>(x, y).w; };
      EXPECT_EQ(alpha(26, 24), 1) << way;                     // before the cutoff
      EXPECT_EQ(alpha(38, 24), double_sided ? 1 : 0) << way;  // a hole; behind it the other's back
    }
  }
}

// Geometry that items share has its bottom level, placed for each.
TEST_F(Traversal, NamesInstances) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  constexpr int side = 40;
  std::vector<float> position, color;
  std::vector<uint16_t> index;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) {
      const float u = float(x) / side - 0.5f, v = float(y) / side - 0.5f;
      position.insert(position.end(), {u, v, 0.5f * std::sin(6 * u) * std::cos(5 * v)});
      color.insert(color.end(), {float(x % 3) / 2, float(y % 4) / 3, 0.5f + u});
    }
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const uint16_t c = uint16_t(y * (side + 1) + x), up = uint16_t(c + side + 1);
      index.insert(index.end(), {c, uint16_t(c + 1), up, up, uint16_t(c + 1), uint16_t(up + 1)});
    }
  Json& p =
      b.primitive({{"POSITION", b.accessor<float>("VEC3", position)}, {"COLOR_0", b.accessor<float>("VEC3", color)}});
  p["indices"] = b.accessor<uint16_t>("SCALAR", index);
  Json material = unlit_material(0.5, 0.5, 0.5);
  material["doubleSided"] = true;
  p["material"] = add_material(b, material);
  for (int i = 0; i < 8; ++i)  // some mirrored
    add_node(b, {{"mesh", 0},
                 {"translation", {(i % 4) - 1.5, i / 4 - 0.5, -0.3 * i}},
                 {"scale", {i % 3 == 0 ? -0.9 : 0.8, 0.7, 1.1}},
                 {"rotation", {0, std::sin(0.1 * i), 0, std::cos(0.1 * i)}}});
  Job job = drawn(write(b));
  look(job, {0, 0, 4}, {0, 0, 0});
  job.settings.push_back({"bvh", "repeated", "0"});
  const auto session = open(job);
  ASSERT_TRUE(session);
  const FrameResult result = render(*session);
  ASSERT_EQ(result.rays->statistics.instances, 8u);
  const Images truth = images(result);
  for (const std::string& way : ways()) expect_same(truth, images_of(by(job, way)), way);
}

// Shadows and occlusion ask too, where queries are.
TEST_F(Traversal, LightAsksTheDevice) {
  const std::vector<std::string> names = ways();
  if (std::find(names.begin(), names.end(), "query") == names.end()) GTEST_SKIP() << "the device has no ray queries";
  Job job = job_for(scene("spheres"), 32, 18);
  job.technique = "hybrid";
  job.effects = "shadows,occlusion";
  job.settings = {{"occlusion", "rays", "8"}};
  const Images truth = images_of(job);
  expect_same(truth, images_of(by(job, "query")), "query");
}

// What moves has trees of its own in each frame.
TEST_F(Traversal, FollowsWhatMoves) {
  Job job = drawn(scene("skinned"));
  for (const std::string& way : ways()) {
    const auto trees = open(job), device = open(by(job, way));
    ASSERT_TRUE(trees && device);
    for (const double time_s : {0.0, 0.5, 0.0})
      expect_same(images(render(*trees, time_s)), images(render(*device, time_s)), fmt::format("{} {}", way, time_s));
  }
}

}  // namespace candela::test::frame_traversal
