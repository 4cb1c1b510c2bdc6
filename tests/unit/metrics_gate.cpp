#include <gtest/gtest.h>

#include "metrics/gate.h"

namespace candela {
namespace {

// A smooth ramp of 8-bit codes, away from the ends.
FloatImage ramp(int side = 64) {
  FloatImage image{.width = side, .height = side};
  for (const char* name : {"R", "G", "B"}) {
    Channel& channel = image.channels.emplace_back();
    channel.name = name;
    for (int i = 0; i < side * side; ++i) channel.f.push_back(float(60 + (i % side)) / 255.0f);
  }
  return image;
}
FloatImage changed(FloatImage image, int pixels, int codes) {
  for (Channel& channel : image.channels)
    for (int i = 0; i < pixels; ++i) {
      float& v = channel.f[size_t(i)];
      v = float(std::lround(v * 255) + codes) / 255.0f;
    }
  return image;
}

TEST(Gate, Rungs) {
  const FloatImage golden = ramp();
  const GateLimits limits;
  EXPECT_EQ(judge_golden(golden, golden, limits).level, GateLevel::identical);
  // One code anywhere, two codes in 4 of 4096 pixels: under 0.1 %.
  EXPECT_EQ(judge_golden(golden, changed(golden, 4096, 1), limits).level, GateLevel::nearly_identical);
  EXPECT_EQ(judge_golden(golden, changed(golden, 4, 2), limits).level, GateLevel::nearly_identical);
  // Two codes in 5 pixels are over 0.1 %, three codes over the largest difference: FLIP decides, and does not see them.
  EXPECT_EQ(judge_golden(golden, changed(golden, 5, 2), limits).level, GateLevel::warned);
  EXPECT_EQ(judge_golden(golden, changed(golden, 2, 3), limits).level, GateLevel::warned);
  EXPECT_TRUE(judge_golden(golden, changed(golden, 2, 3), limits).passed());
  // Half of the image 60 codes brighter.
  const GateResult failed = judge_golden(golden, changed(golden, 2048, 60), limits);
  EXPECT_EQ(failed.level, GateLevel::failed);
  EXPECT_GT(failed.comparison.metrics.at("flip"), 0.01);
  EXPECT_NE(failed.message, "");
}

// FLIP sees alpha by what it leaves of the colour, the first level by itself.
TEST(Gate, AlphaCounts) {
  FloatImage golden = ramp();
  Channel& alpha = golden.channels.emplace_back();
  alpha.name = "A";
  alpha.f.assign(64 * 64, 1.0f);
  FloatImage thinner = golden;
  for (float& a : thinner.channels.back().f) a = 0.5f;
  const GateResult result = judge_golden(golden, thinner, {});
  EXPECT_EQ(result.level, GateLevel::failed);
  EXPECT_EQ(result.small_fraction, 1);
  thinner = golden;
  for (float& a : thinner.channels.back().f) a = 254.0f / 255;
  EXPECT_EQ(judge_golden(golden, thinner, {}).level, GateLevel::nearly_identical);
}

// A small patch may be hidden by the mean: the 99th percentile sees it.
TEST(Gate, PercentileSeesASmallPatch) {
  const FloatImage golden = ramp();
  GateLimits limits;
  limits.flip_mean = 1;
  EXPECT_EQ(judge_golden(golden, changed(golden, 200, 150), limits).level, GateLevel::failed);
  limits.flip_p99 = 1;
  EXPECT_EQ(judge_golden(golden, changed(golden, 200, 150), limits).level, GateLevel::warned);
}

// Limits of warnings lie below those that fail: within them a difference passes in silence, beyond them with a warning.
TEST(Gate, WarningsHaveLimitsOfTheirOwn) {
  const FloatImage golden = ramp();
  const FloatImage off = changed(golden, 5, 3);
  const GateResult plain = judge_golden(golden, off, {});
  EXPECT_EQ(plain.level, GateLevel::warned);
  EXPECT_NEAR(plain.largest, 3.0 / 255, 1e-4);
  const double flip = plain.comparison.metrics.at("flip");
  ASSERT_GT(flip, 0);
  GateLimits limits;
  limits.warn = GateLimits::Warn{.max_abs = 4.0 / 255};
  EXPECT_EQ(judge_golden(golden, off, limits).level, GateLevel::similar);
  EXPECT_TRUE(judge_golden(golden, off, limits).passed());
  limits.warn->max_abs = 2.5 / 255;
  EXPECT_EQ(judge_golden(golden, off, limits).level, GateLevel::warned);
  limits.warn = GateLimits::Warn{.flip_mean = flip / 2};
  EXPECT_EQ(judge_golden(golden, off, limits).level, GateLevel::warned);
  limits.warn = GateLimits::Warn{.flip_mean = flip * 2};
  EXPECT_EQ(judge_golden(golden, off, limits).level, GateLevel::similar);
  // A patch that the percentile alone sees.
  limits.flip_mean = limits.flip_p99 = 1;
  const FloatImage patch = changed(golden, 200, 150);
  const double p99 = judge_golden(golden, patch, limits).flip_p99;
  ASSERT_GT(p99, 0);
  limits.warn = GateLimits::Warn{.flip_p99 = p99 / 2};
  EXPECT_EQ(judge_golden(golden, patch, limits).level, GateLevel::warned);
  limits.warn = GateLimits::Warn{.flip_p99 = p99 * 2};
  EXPECT_EQ(judge_golden(golden, patch, limits).level, GateLevel::similar);
  limits.flip_p99 = p99 / 2;
  // What fails, fails with or without.
  EXPECT_EQ(judge_golden(golden, patch, limits).level, GateLevel::failed);
}

TEST(Gate, WarningLimitsFromJson) {
  const std::string text =
      R"({"gate": {"warn": {"flip_mean": 0.004}, "device_classes": {"cpu": {"warn": {"flip_p99": 0.05}}}}})";
  const auto cpu = parse_gate_limits(text, "cpu", "box.json"), gpu = parse_gate_limits(text, "gpu", "box.json");
  ASSERT_TRUE(cpu && gpu && cpu->warn && gpu->warn);
  EXPECT_EQ(cpu->warn->flip_mean, 0.004);
  EXPECT_EQ(cpu->warn->flip_p99, 0.05);
  EXPECT_TRUE(std::isinf(gpu->warn->flip_p99));
  EXPECT_TRUE(std::isinf(cpu->warn->max_abs));
  const auto again = parse_gate_limits(gate_limits_json(*cpu), "gpu", "box.json");
  ASSERT_TRUE(again && again->warn);
  EXPECT_EQ(again->warn->flip_p99, 0.05);
  EXPECT_FALSE(parse_gate_limits(R"({"gate": {}})", "cpu", "box.json")->warn);
  for (const auto& [bad, says] :
       {std::pair{R"({"gate": {"warn": 1}})", "/gate/warn"},
        {R"({"gate": {"warn": {"small_abs": 0.1}}})", "small_abs"},
        {R"({"gate": {"warn": {"flip_mean": -1}}})", "at least 0"},
        {R"({"gate": {"warn": {"flip_mean": 0.02}}})", "beyond what fails"},
        {R"({"gate": {"flip_p99": 0.01, "warn": {"flip_p99": 0.05}}})", "beyond what fails"}}) {
    const auto parsed = parse_gate_limits(bad, "cpu", "box.json");
    ASSERT_FALSE(parsed) << bad;
    EXPECT_NE(parsed.error().text().find(says), std::string::npos) << parsed.error().text();
  }
}

TEST(Gate, BrokenImagesFail) {
  const FloatImage golden = ramp();
  FloatImage broken = golden;
  broken.channels[0].f[5] = std::nanf("");
  EXPECT_EQ(judge_golden(golden, broken, {}).level, GateLevel::failed);
  EXPECT_EQ(judge_golden(golden, ramp(32), {}).level, GateLevel::failed);
  FloatImage black = golden;
  for (Channel& channel : black.channels) std::fill(channel.f.begin(), channel.f.end(), 0.0f);
  const GateResult result = judge_golden(golden, black, {});
  EXPECT_TRUE(result.blank);
  EXPECT_EQ(result.level, GateLevel::failed);
  EXPECT_FALSE(judge_golden(golden, golden, {}).blank);
  EXPECT_TRUE(judge_golden(black, black, {}).blank);
}

TEST(Gate, LimitsFromJson) {
  const std::string text =
      R"({"scene": "Box", "gate": {"flip_mean": 0.5, "device_classes": {"cpu": {"flip_p99": 0.25}}}})";
  const auto cpu = parse_gate_limits(text, "cpu", "box.json"), gpu = parse_gate_limits(text, "gpu", "box.json");
  ASSERT_TRUE(cpu && gpu);
  EXPECT_EQ(cpu->flip_mean, 0.5);
  EXPECT_EQ(cpu->flip_p99, 0.25);
  EXPECT_EQ(gpu->flip_p99, 0.10);
  const auto again = parse_gate_limits(gate_limits_json(*cpu), "gpu", "box.json");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->flip_p99, 0.25);
  for (const char* bad : {"", "[]", R"({"gate": 1})", R"({"gate": {"flip": 1}})", R"({"gate": {"flip_mean": -1}})",
                          R"({"gate": {"device_classes": {"cpu": {"x": 1}}}})"}) {
    const auto parsed = parse_gate_limits(bad, "cpu", "box.json");
    ASSERT_FALSE(parsed) << bad;
    EXPECT_EQ(parsed.error().kind, ErrorKind::input);
  }
}

}  // namespace
}  // namespace candela
