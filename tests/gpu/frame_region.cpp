// A region has the pixels of the whole picture, bit for bit; what reaches over all of it has the whole rendered.
#include "frame_fixture.h"
#include "job/picture_window.h"
#include "techniques/technique.h"

namespace candela::test::frame_region {
namespace {

constexpr int width = 256, height = 160;
constexpr PixelRect region{151, 87, 43, 29};

}  // namespace

class FrameRegion : public FrameTest {
 protected:
  static Job street() {
    Job job = job_for(scene("street"), width, height, 4);
    job.sky = "studio";  // ambient light, which occlusion takes from
    return job;
  }
  // What the region holds of each output of the whole picture.
  static void expect_part_of_whole(Job job, bool restricted, double time_s = 0, const WantedOutputs& wanted = {}) {
    const Images whole = images_of(job, wanted, time_s);
    const PictureWindow all = picture_window(job);
    job.region = region;
    const auto session = open(job, wanted);
    ASSERT_TRUE(session);
    const FrameResult result = render(*session, time_s);
    EXPECT_EQ(result.plan->parts.has_value(), restricted);
    if (result.plan->parts) {
      EXPECT_LT(result.plan->parts->shaded.width * result.plan->parts->shaded.height, all.width_px * all.height_px);
      EXPECT_TRUE(holds(result.plan->parts->seen, result.plan->parts->shaded));
    }
    const Images part = images(result);
    ASSERT_EQ(part.size(), whole.size());
    const PixelRect at = picture_window(job).part;
    for (size_t i = 0; i < part.size(); ++i) {
      ASSERT_EQ(part.at(i).layer, whole.at(i).layer);
      const size_t texel = whole.at(i).bytes.size() / (size_t(all.width_px) * size_t(all.height_px));
      ASSERT_EQ(part.at(i).bytes.size(), texel * size_t(at.width) * size_t(at.height)) << part.at(i).layer;
      size_t rows = 0;
      for (int y = 0; y < at.height; ++y)
        rows += std::memcmp(&part.at(i).bytes[size_t(y) * size_t(at.width) * texel],
                            &whole.at(i).bytes[(size_t(at.y + y) * size_t(all.width_px) + size_t(at.x)) * texel],
                            size_t(at.width) * texel) == 0;
      EXPECT_EQ(rows, size_t(at.height)) << part.at(i).layer;
    }
  }
};

TEST_F(FrameRegion, PixelsAreThoseOfTheWholeWithEveryTechnique) {
  for (const Technique& technique : techniques()) {
    SCOPED_TRACE(technique.name);
    Job job = street();
    job.technique = technique.name;
    expect_part_of_whole(job, true);
  }
}

// Rays to lights by a pass of their own, as GPUs send them: what its records begin with is written by its first group,
// wherever the region lies.
TEST_F(FrameRegion, PixelsAreThoseOfTheWholeWhereRaysToLightsHaveAPass) {
  Job job = street();
  job.technique = "hybrid";
  job.settings.push_back({"light_rays", "apart", "on"});
  expect_part_of_whole(job, true);
}

TEST_F(FrameRegion, PixelsAreThoseOfTheWholeAtEveryQuality) {
  for (const char* quality : {"draft", "normal"}) {
    SCOPED_TRACE(quality);
    Job job = street();
    job.quality = quality, job.samples = 0;
    expect_part_of_whole(job, true);
  }
  Job exact = street();
  exact.quality = "exact", exact.samples = 0;
  for (const char* setting : {"supersample.n=2", "occlusion.rays=2", "sun.samples=2", "local.samples=2"})
    exact.settings.push_back(*parse_knob_setting(setting));
  expect_part_of_whole(exact, true);
}

// Images and keys of a large picture have memory about the region alone, where the device can.
TEST_F(FrameRegion, PagesAboutTheRegionHoldThePixelsOfTheWhole) {
  for (const char* technique : {"clustered", "deferred-tiled", "visibility", "ray"}) {
    SCOPED_TRACE(technique);
    Job job = street();
    job.technique = technique, job.quality = "draft", job.samples = 1;
    job.width_px = 1024, job.height_px = 640;
    job.settings.push_back({"occlusion", "texel_px", "2"});
    expect_part_of_whole(job, true);
    job.region = region;
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult result = render(*session, 0);
    const FramePlan& plan = *result.plan;
    EXPECT_LT(transient_bytes(plan), transient_bytes_whole(plan));
    if (session->device().info().paged_bytes == 0) continue;
    // Of the largest image or buffer alone that much is saved; lavapipe has no pages for what is drawn into.
    constexpr VkImageUsageFlags drawn =
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    uint64_t saved = 0;
    for (const PlanResource& r : plan.resources)
      if (r.resident && !(session->device().info().is_cpu && (r.image_usage & drawn)))
        saved = std::max(saved, whole_bytes(r) - r.bytes);
    if (std::string_view(technique) == "ray") EXPECT_GT(saved, 0u);
    if (saved > 0) EXPECT_LT(session->device().memory_use().frame + saved / 2, transient_bytes_whole(plan));
  }
}

TEST_F(FrameRegion, DisplayOutputAndEveryLayerAreThoseOfTheWhole) {
  Job job = with_layers(street());
  job.tonemap = "agx";
  WantedOutputs both;
  both.display = true;
  expect_part_of_whole(job, true, 0, both);
}

TEST_F(FrameRegion, OcclusionByTheScreenFindsDepthsBeyondTheRegion) {
  Job job = street();
  job.settings.push_back({"occlusion", "method", "screen"});
  expect_part_of_whole(job, true);
}

TEST_F(FrameRegion, FogAndLightInTheAirAreThoseOfTheWhole) {
  Job job = street();
  job.look = look_file(R"({"fog": {"extinction": 0.03, "albedo": 0.9}, "volumetric": {"phi": 2}})");
  job.layers = {"fog", "volumetric"};
  expect_part_of_whole(job, true);
  job.settings.push_back({"fog", "method", "march"});
  expect_part_of_whole(job, true);
}

TEST_F(FrameRegion, BlendedSurfacesAreThoseOfTheWhole) {
  for (const char* method : {"sorted", "weighted", "moments", "layers"}) {
    SCOPED_TRACE(method);
    Job job = job_for(scene("alpha"), width, height, 4);
    job.transparency = method;
    expect_part_of_whole(job, true);
  }
}

TEST_F(FrameRegion, WhatReachesOverThePictureHasTheWholeRendered) {
  WantedOutputs display;
  display.display = true;
  Job job = street();
  job.look = look_file(R"({"bloom": {}})");
  expect_part_of_whole(job, false, 0, display);
  job.look = look_file(R"({"exposure": {"auto": {}}})");
  expect_part_of_whole(job, false, 0, display);
  expect_part_of_whole(job, true);  // linear output is not exposed
  job.look = look_file(R"({"reflections": {}})");
  job.settings.push_back({"reflections", "method", "screen"});
  expect_part_of_whole(job, false);
  expect_part_of_whole(job_for(scene("glass"), width, height, 4), false);
}

TEST_F(FrameRegion, RegionsLieInTheOverscan) {
  Job job = street();
  job.overscan = {10, true};
  expect_part_of_whole(job, true);
}

// The overscan's middle shows what the picture without it shows: the same rays but for the rounding of the projection.
TEST_F(FrameRegion, OverscanGoesOnAboutThePicture) {
  Job job = street();
  job.quality = "draft", job.effects = "none";
  const Images plain = images_of(job);
  job.overscan = {16, false};
  const Images wide = images_of(job);
  const auto& a = plain["beauty"];
  const auto& b = wide["beauty"];
  ASSERT_EQ(b.width, width + 32);
  ASSERT_EQ(b.height, height + 32);
  const std::vector<glm::vec4> inner = a.values<glm::vec4>(), outer = b.values<glm::vec4>();
  double sum = 0, off = 0, off_by_one_pixel = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::vec4 p = inner[size_t(y) * width + size_t(x)],
                      q = outer[size_t(y + 16) * size_t(b.width) + size_t(x + 16)];
      const glm::vec4 beside = outer[size_t(y + 16) * size_t(b.width) + size_t(x + 17)];
      sum += double(glm::length(p)), off += double(glm::length(p - q));
      off_by_one_pixel += double(glm::length(p - beside));
    }
  EXPECT_LT(off, 0.002 * sum);
  EXPECT_GT(off_by_one_pixel, 20 * off);
}

}  // namespace candela::test::frame_region
