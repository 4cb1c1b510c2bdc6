#include "passes/shared/bvh_knobs.h"
#include "session/device_samples.h"

#include <gtest/gtest.h>

namespace candela::test {
namespace {

TEST(DeviceSamples, ThatADeviceLacksAreRefused) {
  Job job;
  job.samples = 8;
  const auto none = check_samples(job, {1, 4}, "a device");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::device);
  EXPECT_NE(none.error().text().find("a device has no 8 samples a pixel; it has 1, 4"), std::string::npos)
      << none.error().text();
  EXPECT_TRUE(check_samples(job, {1, 2, 4, 8}, "a device"));
  // By the knob too.
  job.samples = 0;
  job.settings = {{"resolve", "samples", "2"}};
  EXPECT_FALSE(check_samples(job, {1, 4}, "a device"));
  EXPECT_TRUE(check_samples(job, {1, 2, 4}, "a device"));
}

TEST(DeviceSamples, OfEveryQualityAreOnEveryDevice) {
  for (const char* quality : {"draft", "normal", "high", "exact"}) {
    Job job;
    job.quality = quality;
    EXPECT_TRUE(check_samples(job, {1, 4}, "what Vulkan promises")) << quality;
  }
}

TEST(DeviceTraversal, ThatADeviceLacksIsRefused) {
  BvhKnobs knobs;
  EXPECT_TRUE(check_traversal(knobs, {}, "a device"));
  const auto refusal = [&](int traversal, gpu::RayExtensions has) {
    knobs.traversal = traversal;
    const auto fine = check_traversal(knobs, has, "a device");
    return fine ? std::string("fine") : fine.error().message;
  };
  EXPECT_EQ(refusal(BvhKnobs::by_query, {true, false}), "fine");
  EXPECT_EQ(refusal(BvhKnobs::by_pipeline, {false, true}), "fine");
  EXPECT_EQ(refusal(BvhKnobs::by_query, {false, true}),
            "a device has no VK_KHR_ray_query; set bvh.traversal=pipeline or shader, or choose another device with "
            "--device");
  EXPECT_EQ(refusal(BvhKnobs::by_pipeline, {true, false}),
            "a device has no VK_KHR_ray_tracing_pipeline; set bvh.traversal=query or shader, or choose another device "
            "with --device");
  EXPECT_EQ(refusal(BvhKnobs::by_query, {}),
            "a device has no VK_KHR_ray_query; set bvh.traversal=shader, or choose another device with --device");
}

}  // namespace
}  // namespace candela::test
