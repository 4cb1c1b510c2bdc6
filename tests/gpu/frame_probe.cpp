// The sphere of --probe.
#include <numbers>

#include "frame_fixture.h"

namespace candela::test {

class FrameProbe : public FrameTest {
 protected:
  // A small cube far off, which the probe must not hide by its size, seen under the neutral light or a lamp.
  static Job probed(const char* kind, glm::dvec3 eye, glm::dvec3 target) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json pbr = base_color(1, 0, 0);
    add_node(b, {{"mesh", add_square_mesh(b, 0.2f, add_material(b, {{"pbrMetallicRoughness", pbr}}))},
                 {"translation", {0, 0, -3}}});
    Job job = job_for(write(b), 80, 60);
    job.effects = "none";
    job.probe = kind;
    job.layers = {"albedo"};
    look(job, eye, target, 60);
    return job;
  }
  // Pixels that show it, and their middle.
  static std::pair<size_t, glm::dvec2> seen(const Images& images, float albedo) {
    size_t count = 0;
    glm::dvec2 sum(0);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x) {
        const glm::vec4 p = images["albedo"].at<glm::vec4>(x, y);
        if (std::abs(p.y - albedo) > 1e-6f || std::abs(p.x - p.y) > 1e-6f) continue;
        ++count;
        sum += glm::dvec2(x + 0.5, y + 0.5);
      }
    return {count, sum / double(std::max<size_t>(count, 1))};
  }
};

// A quarter of the height across, in the middle, whatever the camera; and its albedo is what its name says.
TEST_F(FrameProbe, StandsInTheMiddleOfEveryView) {
  const std::pair<const char*, float> kinds[] = {{"white", 0.9f}, {"grey", 0.18f}, {"chrome", 1.0f}};
  const std::pair<glm::dvec3, glm::dvec3> views[] = {{{0, 0, 0}, {0, 0, -1}}, {{1e5, 3, -1}, {1e5 + 1, 2, -5}}};
  for (const auto& [kind, albedo] : kinds)
    for (const auto& [eye, target] : views) {
      const auto [count, middle] = seen(images_of(probed(kind, eye, target)), albedo);
      EXPECT_NEAR(double(count), std::numbers::pi * 7.5 * 7.5, 12) << kind;
      EXPECT_NEAR(middle.x, 40, 0.3) << kind;
      EXPECT_NEAR(middle.y, 30, 0.3) << kind;
    }
}

// Where the picture is of a model without cameras, the model is framed as without a probe.
TEST_F(FrameProbe, DoesNotMoveTheView) {
  Job job = probed("grey", {}, {});
  job.camera = {};
  const auto with = open(job), without = [&] {
    Job none = job;
    none.probe.clear();
    return open(none);
  }();
  const FrameResult a = render(*with, 0, false), b = render(*without, 0, false);
  EXPECT_EQ(a.view.position, b.view.position);
  EXPECT_EQ(a.view.clip_from_relative, b.view.clip_from_relative);
  EXPECT_EQ(seen(images(b), 0.18f).first, 0u);
  EXPECT_GT(seen(images(a), 0.18f).first, 100u);
}

}  // namespace candela::test
