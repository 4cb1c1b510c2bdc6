// What PNG and video show with --view, and --shading.
#include "frame_fixture.h"
#include "render/outputs.h"

namespace candela::test {

class FrameViews : public FrameTest {
 protected:
  static DisplayImage picture_of(Job job, bool files = true) {
    const auto session = open(job, {.linear = false, .display = true, .display_bits = job.png_bits, .files = files});
    if (!session) return {};
    const FrameResult frame = render(*session);
    return display_image(frame, job);
  }
  static Job viewed(const std::string& name, const std::string& view) {
    Job job = job_for(scene(name), 96, 54);
    job.view = view;
    return job;
  }
  static size_t lit(const DisplayImage& picture) {
    size_t count = 0;
    for (size_t i = 0; i < picture.pixels.size(); i += 3)
      count += picture.pixels[i] != std::byte(0) || picture.pixels[i + 1] != std::byte(0) ||
               picture.pixels[i + 2] != std::byte(0);
    return count;
  }
};

// Each under validation, packed for files and not.
TEST_F(FrameViews, EveryLayerHasAPicture) {
  for (const std::string& view : view_names()) {
    Job job = viewed("spheres", view);
    job.background = "0.1,0.1,0.1";
    const DisplayImage packed = picture_of(job);
    EXPECT_EQ(packed.width, 96) << view;
    EXPECT_EQ(packed.channels, 3) << view;
    EXPECT_EQ(packed.pixels.size(), 96u * 54u * 3u) << view;
    const bool of_every_form = view == "depth" || view == "normal" || view == "albedo" || view == "object_id" ||
                               view == "shadow_local" || view == "heatmap_lights" || view == "direct";
    if (!of_every_form) continue;
    EXPECT_GT(lit(packed), 400u) << view;
    EXPECT_EQ(packed.pixels, picture_of(job, false).pixels) << view;
  }
}

// An unlit surface's picture is its emission: the same curve, exposure and dither.
TEST_F(FrameViews, LightGoesThroughTheCurveOfBeauty) {
  Job job = viewed("unlit-box", "beauty");
  job.background = "0,0,0";
  job.tonemap = "agx";
  job.exposure_ev = 1.5f;
  const DisplayImage beauty = picture_of(job);
  job.view = "emission";
  const DisplayImage emission = picture_of(job);
  EXPECT_EQ(beauty.pixels, emission.pixels);
  job.exposure_ev = 2.5f;
  EXPECT_NE(picture_of(job).pixels, emission.pixels);
}

TEST_F(FrameViews, AnImageOfTheFrame) {
  Job job = viewed("spheres", "debug.tonemap.display");
  const DisplayImage picture = picture_of(job);
  EXPECT_GT(lit(picture), 400u);
  job.view = "debug.depth_prepass.depth";
  EXPECT_GT(lit(picture_of(job)), 400u);
  EXPECT_EQ(picture_of(job).pixels, picture_of(job, false).pixels);
  job.view = "debug.depth_prepass.dept";
  const auto session = open(job, {.linear = false, .display = true});
  ASSERT_TRUE(session);
  const auto frame = session->render(0);
  ASSERT_FALSE(frame);
  EXPECT_NE(frame.error().text().find("--view"), std::string::npos) << frame.error().text();
  EXPECT_NE(frame.error().text().find("depth_prepass.depth"), std::string::npos) << frame.error().text();
}

// A layer that a scene has not: black, and a warning.
TEST_F(FrameViews, WhatIsNotThereIsBlack) {
  const DisplayImage picture = picture_of(viewed("spheres", "fog"));
  EXPECT_EQ(lit(picture), 0u);
  Job job = viewed("spheres", "fog");
  const auto session = open(job, {.linear = false, .display = true, .files = true});
  FrameResult frame = render(*session);
  const std::string path = ::testing::TempDir() + "candela_no_fog.png";
  ASSERT_TRUE(write_outputs(frame, job, *session, 0, FrameRate{}, {path}));
  std::filesystem::remove(path);
  ASSERT_FALSE(frame.warnings.empty());
  EXPECT_NE(frame.warnings.back().find("no fog"), std::string::npos) << frame.warnings.back();
}

// A view that is light is read back as the picture alone, and needs none of beauty's passes.
TEST_F(FrameViews, NothingElseIsReadBack) {
  const Job job = viewed("spheres", "direct");
  const auto session = open(job, {.linear = false, .display = true, .files = true});
  const FrameResult frame = render(*session);
  uint64_t read_back = 0;
  for (const auto& [resource, readback] : frame.readbacks) read_back += readback->bytes().size();
  EXPECT_LT(read_back, 96u * 54u * 4u);
  EXPECT_GT(read_back, 96u * 54u * 3u - 1);
}

// A square before the camera under a light along its normal: albedo E / pi, whatever metal and gloss the file has, and
// nothing is mirrored.
TEST_F(FrameViews, LambertIsTheBaseColourAlone) {
  GltfBuilder b = empty_scene();
  Json pbr = base_color(0.5f, 0.25f, 1);
  pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.2;
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, {{"pbrMetallicRoughness", pbr}}))},
               {"translation", {0, 0, -3}}});
  add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {});
  Job job = job_for(write(b), 16, 16);
  look(job, {0, 0, 0}, {0, 0, -1}, 40);
  job.effects = "none";
  job.exr_float = true;
  job.shading = "lambert";
  job.layers = {"direct", "ambient_specular"};
  const Images lambert = images_of(job);
  const glm::vec4 seen = lambert["direct"].at<glm::vec4>(8, 8);
  const glm::vec3 expected = glm::vec3(0.5f, 0.25f, 1) * 2.0f / glm::pi<float>();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], 1e-5f) << c;
  for (const glm::vec4& v : lambert["ambient_specular"].values<glm::vec4>()) EXPECT_EQ(glm::vec3(v), glm::vec3(0));
  job.shading = "pbr";
  EXPECT_GT(std::abs(images_of(job)["direct"].at<glm::vec4>(8, 8).y - expected.y), 0.01f);
}

}  // namespace candela::test
