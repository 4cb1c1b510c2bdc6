#include <gtest/gtest.h>

#include <cstring>

#include "image/io.h"
#include "metrics/compare.h"
#include "metrics/heatmap.h"
#include "metrics/limits.h"
#include "metrics/ssim.h"

namespace candela {
namespace {

FloatImage noise(int width, int height, uint32_t seed, float largest = 1.0f) {
  FloatImage image{.width = width, .height = height};
  uint32_t state = seed;
  for (const char* name : {"R", "G", "B"}) {
    Channel& channel = image.channels.emplace_back();
    channel.name = name;
    for (int i = 0; i < width * height; ++i)
      channel.f.push_back(float((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0f * largest);
  }
  return image;
}

double srgb(double v) {
  v = std::clamp(v, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

TEST(Compare, NumericMetricsAgreeWithBruteForce) {
  const FloatImage a = noise(13, 9, 1, 3.0f), b = noise(13, 9, 2, 3.0f);
  double largest = 0, absolute = 0, square = 0, relative = 0, encoded = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < 13 * 9; ++i) {
      const double r = a.channels[c].f[i], t = b.channels[c].f[i], d = t - r;
      largest = std::max(largest, std::abs(d));
      absolute += std::abs(d), square += d * d, relative += d * d / (r * r + 0.01);
      encoded += (srgb(t) - srgb(r)) * (srgb(t) - srgb(r));
    }
  const double n = 3 * 13 * 9;
  const Comparison result = compare(a, b, {Encoding::linear});
  ASSERT_EQ(result.refusal, "");
  const auto& m = result.metrics;
  EXPECT_NEAR(m.at("max"), largest, 1e-12);
  EXPECT_NEAR(m.at("mae"), absolute / n, 1e-12);
  EXPECT_NEAR(m.at("rmse"), std::sqrt(square / n), 1e-12);
  EXPECT_NEAR(m.at("relmse"), relative / n, 1e-9);
  EXPECT_NEAR(m.at("psnr"), -10 * std::log10(encoded / n), 1e-5);
  EXPECT_EQ(m.at("differing"), 13 * 9);
}

// The definition, written as plainly as it goes: windows in double, no separation.
double brute_force_ssim(const FloatImage& a, const FloatImage& b) {
  const auto luma = [](const FloatImage& image, int x, int y) {
    const size_t i = size_t(y * image.width + x);
    return 0.2126 * image.channels[0].f[i] + 0.7152 * image.channels[1].f[i] + 0.0722 * image.channels[2].f[i];
  };
  double total = 0;
  int count = 0;
  for (int y = 5; y < a.height - 5; ++y)
    for (int x = 5; x < a.width - 5; ++x, ++count) {
      double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int v = -5; v <= 5; ++v)
        for (int u = -5; u <= 5; ++u) {
          const double g = std::exp(-(u * u + v * v) / 4.5), pa = luma(a, x + u, y + v), pb = luma(b, x + u, y + v);
          w += g, ma += g * pa, mb += g * pb, aa += g * pa * pa, bb += g * pb * pb, ab += g * pa * pb;
        }
      ma /= w, mb /= w, aa = aa / w - ma * ma, bb = bb / w - mb * mb, ab = ab / w - ma * mb;
      total += (2 * ma * mb + 1e-4) * (2 * ab + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (aa + bb + 9e-4));
    }
  return total / count;
}

TEST(Compare, SsimAgreesWithBruteForce) {
  const FloatImage a = noise(23, 17, 5), other = noise(23, 17, 6);
  FloatImage b = a;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < b.channels[c].f.size(); ++i)
      b.channels[c].f[i] = 0.7f * b.channels[c].f[i] + 0.2f * other.channels[c].f[i];
  EXPECT_NEAR(compare(a, b, {}).metrics.at("ssim"), brute_force_ssim(a, b), 1e-5);
}

// Of colours, and of what has luminance alone, which is grey.
TEST(Compare, HdrFlipIsOfTheColoursThatAreThere) {
  const CompareOptions options{.encoding = Encoding::linear, .hdr_flip = HdrFlipChoice{}};
  const FloatImage a = noise(13, 11, 3);
  EXPECT_EQ(compare(a, a, options).metrics.at("hdr-flip"), 0);
  FloatImage darker = a;
  for (Channel& channel : darker.channels)
    for (float& v : channel.f) v *= 0.5f;
  EXPECT_GT(compare(a, darker, options).metrics.at("hdr-flip"), 0.05);
  const auto grey_of = [](const FloatImage& image, std::initializer_list<const char*> names) {
    FloatImage grey{.width = image.width, .height = image.height};
    for (const char* name : names) grey.channels.push_back({name, ChannelType::float32, image.channels[0].f, {}});
    return grey;
  };
  EXPECT_EQ(compare(grey_of(a, {"Y"}), grey_of(darker, {"Y"}), options).metrics.at("hdr-flip"),
            compare(grey_of(a, {"R", "G", "B"}), grey_of(darker, {"R", "G", "B"}), options).metrics.at("hdr-flip"));
}

TEST(Compare, EqualImages) {
  const FloatImage a = noise(7, 6, 3);  // smaller than the window of SSIM
  const Comparison result = compare(a, a, {});
  EXPECT_EQ(result.metrics.at("max"), 0);
  EXPECT_EQ(result.metrics.at("flip"), 0);
  EXPECT_EQ(result.metrics.at("differing"), 0);
  EXPECT_EQ(result.metrics.at("psnr"), psnr_of_equal);
  EXPECT_NEAR(result.metrics.at("ssim"), 1, 1e-9);
}

TEST(Compare, ResultIsTheSameEveryTime) {
  const FloatImage a = noise(300, 200, 1), b = noise(300, 200, 2);
  const Comparison first = compare(a, b, {});
  for (int i = 0; i < 5; ++i) {
    const Comparison again = compare(a, b, {});
    EXPECT_EQ(again.metrics, first.metrics);
    EXPECT_EQ(again.flip_map, first.flip_map);
  }
}

FloatImage with_alpha(FloatImage image, float alpha) {
  image.channels.push_back(
      {"A", ChannelType::float32, std::vector<float>(size_t(image.width) * size_t(image.height), alpha)});
  return image;
}

TEST(Compare, AlphaOfOneEverywhereIsNone) {
  const FloatImage a = noise(13, 11, 1), b = noise(13, 11, 2);
  const auto metrics = compare(a, b, {.perceptual = true}).metrics;
  for (const auto& [one, other] : {std::pair(with_alpha(a, 1), b), std::pair(a, with_alpha(b, 1))}) {
    const Comparison result = compare(one, other, {});
    EXPECT_EQ(result.refusal, "");
    EXPECT_EQ(result.metrics, metrics);
    ASSERT_EQ(result.notes.size(), 1u);
    EXPECT_NE(result.notes[0].find("alpha"), std::string::npos);
  }
  EXPECT_TRUE(compare(a, b, {}).notes.empty());
  EXPECT_NE(compare(a, with_alpha(b, 0.999f), {}).refusal.find("not 1 everywhere"), std::string::npos);
}

TEST(Compare, TransparentPixelsHaveNoColour) {
  const FloatImage a = with_alpha(noise(13, 11, 1), 0), b = with_alpha(noise(13, 11, 2), 0);
  const auto shown = compare(a, b, {}).metrics;
  EXPECT_EQ(shown.at("flip"), 0);
  EXPECT_EQ(shown.at("psnr"), psnr_of_equal);
  EXPECT_NEAR(shown.at("ssim"), 1, 1e-6);
  EXPECT_GT(shown.at("max"), 0.5) << "values as they are stored";
  // Of files that store colour times alpha it is taken as it is.
  EXPECT_GT(compare(a, b, {.encoding = Encoding::linear}).metrics.at("flip"), 0.1);
  // Half as opaque is half as bright.
  FloatImage half = noise(13, 11, 1);
  for (Channel& channel : half.channels)
    for (float& v : channel.f) v /= 2;
  EXPECT_NEAR(compare(with_alpha(half, 1), with_alpha(noise(13, 11, 1), 0.5f), {}).metrics.at("flip"), 0, 1e-6);
}

TEST(Refusal, SizeChannelsWindow) {
  const FloatImage a = noise(4, 3, 1);
  EXPECT_NE(compare(a, noise(3, 4, 1), {}).refusal.find("sizes"), std::string::npos);
  FloatImage b = a;
  b.channels.push_back({"A", ChannelType::float32, std::vector<float>(12, 0.5f)});
  EXPECT_NE(compare(a, b, {}).refusal.find("channels"), std::string::npos);
  b = a;
  b.origin_x = 2;
  EXPECT_NE(compare(a, b, {}).refusal.find("windows"), std::string::npos);
  EXPECT_TRUE(compare(a, b, {}).metrics.empty());
}

TEST(Refusal, NonFiniteAgainstNumber) {
  const FloatImage good = noise(4, 3, 1);
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
    FloatImage broken = good;
    broken.channels[1].f[6] = bad;
    broken.channels[2].f[6] = bad;
    broken.channels[0].f[9] = bad;
    for (const Comparison& result : {compare(good, broken, {}), compare(broken, good, {})}) {
      EXPECT_NE(result.refusal.find("2 pixels"), std::string::npos) << result.refusal;
      EXPECT_NE(result.refusal.find("(2, 1)"), std::string::npos) << result.refusal;
      const std::vector<Limit> loose = {{"max", 1e30}};
      EXPECT_FALSE(passes(result, judge_limits(result, loose)));
    }
    const Comparison both = compare(broken, broken, {});
    EXPECT_EQ(both.refusal, "");
    EXPECT_EQ(both.nonfinite_in_both, 3u);
    EXPECT_EQ(both.metrics.at("max"), 0);
  }
  FloatImage plus = good, minus = good;
  plus.channels[0].f[0] = INFINITY, minus.channels[0].f[0] = -INFINITY;
  EXPECT_NE(compare(plus, minus, {}).refusal, "");
}

TEST(Compare, IntegersAndLayersCountAsDiffering) {
  FloatImage a = noise(4, 3, 1);
  a.channels.push_back({"id.object", ChannelType::uint32, {}, std::vector<uint32_t>(12, 0x7fc00000u)});
  a.channels.push_back({"depth.Z", ChannelType::float32, std::vector<float>(12, 5.0f)});
  FloatImage b = a;
  b.channels[3].u[2] = 0x7fc00001u;  // two NaNs, were they floats
  b.channels[4].f[7] = 6.0f;
  const Comparison result = compare(a, b, {});
  EXPECT_EQ(result.metrics.at("differing"), 2);
  EXPECT_EQ(result.metrics.at("max"), 0);  // of the colour
}

TEST(CompareFiles, LinearAndDisplayAreNotMixed) {
  const auto folder = std::filesystem::path(testing::TempDir());
  const FloatImage a = noise(4, 3, 1);
  ASSERT_TRUE(write_exr(folder / "compare_a.exr", a));
  const auto same = compare_files(folder / "compare_a.exr", folder / "compare_a.exr");
  ASSERT_TRUE(same);
  EXPECT_EQ(same->metrics.at("differing"), 0);
  const std::filesystem::path picture = CANDELA_SOURCE_DIR "/../shared/flip/FlightHelmet_ref.png";
  if (std::filesystem::exists(picture)) {
    const auto mixed = compare_files(folder / "compare_a.exr", picture);
    ASSERT_TRUE(mixed);
    EXPECT_NE(mixed->refusal.find("scene-linear"), std::string::npos) << mixed->refusal;
  }
  const auto absent = compare_files(folder / "compare_a.exr", folder / "compare_absent.exr");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::input);
}

TEST(Limits, ParseAndJudge) {
  const auto limit = parse_limit("flip=0.02");
  ASSERT_TRUE(limit);
  EXPECT_EQ(limit->metric, "flip");
  EXPECT_EQ(limit->value, 0.02);
  for (const char* bad : {"flip", "flip=", "flip=x", "flip=1x", "flop=1", "=1", "flip=nan", "flip=inf"}) {
    const auto parsed = parse_limit(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_EQ(parsed.error().kind, ErrorKind::usage);
  }
  const Comparison measured{.metrics = {{"flip", 0.05}, {"psnr", 30}}};
  const std::vector<Limit> limits = {{"flip", 0.05}, {"flip", 0.04}, {"psnr", 30}, {"psnr", 31}, {"ssim", 0}};
  const auto verdicts = judge_limits(measured, limits);
  const std::vector<bool> expected = {true, false, true, false, false};  // no ssim: fails
  for (size_t i = 0; i < limits.size(); ++i) EXPECT_EQ(verdicts[i].pass, expected[i]) << i;
  EXPECT_FALSE(passes(measured, verdicts));
  const std::string json = comparison_json(measured, {});
  EXPECT_NE(json.find("\"flip\": 0.05"), std::string::npos) << json;
  EXPECT_NE(json.find("\"pass\": true"), std::string::npos) << json;
}

TEST(Heatmap, EndsAndGrowingLightness) {
  Plane map;
  for (int i = 0; i <= 100; ++i) map.push_back(float(i) / 100);
  map.insert(map.end(), {-1.0f, 7.0f, std::nanf("")});
  const DisplayImage image = heatmap(map, 104, 1);
  const auto code = [&](int i, int c) { return int(uint8_t(image.pixels[size_t(i * 3 + c)])); };
  EXPECT_EQ((std::array{code(0, 0), code(0, 1), code(0, 2)}), (std::array{0, 0, 4}));
  EXPECT_EQ((std::array{code(100, 0), code(100, 1), code(100, 2)}), (std::array{0xfc, 0xfd, 0xbf}));
  for (int i = 1; i <= 100; ++i)
    EXPECT_GE(2126 * code(i, 0) + 7152 * code(i, 1) + 722 * code(i, 2) + 8000,
              2126 * code(i - 1, 0) + 7152 * code(i - 1, 1) + 722 * code(i - 1, 2));
  EXPECT_EQ(code(101, 2), 4);
  EXPECT_EQ(code(102, 0), 0xfc);
  EXPECT_EQ(code(103, 2), 4);
}

}  // namespace
}  // namespace candela
