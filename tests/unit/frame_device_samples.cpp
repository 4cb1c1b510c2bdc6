#include "frame/device_samples.h"

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

}  // namespace
}  // namespace candela::test
