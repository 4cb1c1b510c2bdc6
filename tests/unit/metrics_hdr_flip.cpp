#include <gtest/gtest.h>

#include <algorithm>

#include "metrics/compare.h"
#include "metrics/flip.h"

namespace candela::metrics_hdr_flip {
namespace {

const std::filesystem::path flip_folder = CANDELA_SOURCE_DIR "/../shared/flip";

std::vector<Plane> grey(std::vector<float> values) { return {values, values, values}; }

// EXPECTED.tsv beside the images: means of the authors' program.
TEST(HdrFlip, MeansAreTheAuthors) {
  if (!std::filesystem::exists(flip_folder)) GTEST_SKIP() << "the folder shared/flip is absent";
  const auto mean = [](std::optional<ExposureRange> range) {
    const auto result = compare_files(flip_folder / "market_ref.exr", flip_folder / "market_test.exr",
                                      {.perceptual = false, .hdr_flip = HdrFlipChoice{range}});
    EXPECT_TRUE(result.has_value());
    return result ? result->metrics.at("hdr-flip") : -1;
  };
  EXPECT_NEAR(mean(ExposureRange{-4, 4, 9}), 0.147439, 5e-6);
  EXPECT_NEAR(mean(std::nullopt), 0.149313, 5e-6);
}

TEST(HdrFlip, RangeBringsTheBrightestAndTheMedianToTheSameShownValue) {
  // 11 pixels from 2^-5 to 2^5: the median is 1, the brightest 32.
  std::vector<float> values;
  for (int i = -5; i <= 5; ++i) values.push_back(std::exp2f(float(i)));
  const ExposureRange range = automatic_exposures(grey(values));
  EXPECT_NEAR(range.stop - range.start, 5, 1e-6);
  EXPECT_EQ(range.count, 5);
  const double x = 0.6 * std::exp2(range.stop);
  EXPECT_NEAR((2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14), 0.85, 1e-6);
}

TEST(HdrFlip, BlackMedianAndBlackPicturesHaveARange) {
  std::vector<float> mostly_black(100, 0.0f);
  for (int i = 0; i < 5; ++i) mostly_black[size_t(i)] = 4.0f;
  const ExposureRange range = automatic_exposures(grey(mostly_black));
  EXPECT_TRUE(std::isfinite(range.start) && std::isfinite(range.stop));
  EXPECT_NEAR(range.start, range.stop, 1e-9);  // the five are all alike
  EXPECT_EQ(range.count, 2);
  EXPECT_EQ(automatic_exposures(grey(std::vector<float>(9, 0.0f))), (ExposureRange{0, 0, 1}));
  std::vector<float> broken(9, 1.0f);
  broken[3] = std::nanf(""), broken[4] = INFINITY;
  EXPECT_TRUE(std::isfinite(automatic_exposures(grey(broken)).start));
  // A lit image against a black reference is an error, and a number.
  const Plane map =
      hdr_flip_map(grey(std::vector<float>(64, 0.0f)), grey(std::vector<float>(64, 1.0f)), 8, 8, {0, 0, 1});
  EXPECT_GT(flip_mean(map, 8, 8), 0.5);
  const Plane extreme =
      hdr_flip_map(grey(std::vector<float>(64, 3e38f)), grey(std::vector<float>(64, INFINITY)), 8, 8, {0, 64, 2});
  for (const float v : extreme) EXPECT_EQ(v, 0.0f);  // both are white
}

// What one exposure hides another shows: a difference far above white is 0 at 0 stops and plain at -10.
TEST(HdrFlip, TakesTheWorstExposure) {
  const auto a = grey(std::vector<float>(256, 500.0f)), b = grey(std::vector<float>(256, 1500.0f));
  const auto mean = [&](const ExposureRange& range) { return flip_mean(hdr_flip_map(a, b, 16, 16, range), 16, 16); };
  EXPECT_LT(mean({0, 0, 1}), 1e-3);
  EXPECT_GT(mean({-10, -10, 1}), 0.1);
  EXPECT_EQ(mean({-10, 0, 2}), mean({-10, -10, 1}));
}

// As the authors' program has it: the curve of a negative value is that of a bright one.
TEST(HdrFlip, NegativeRadianceGoesThroughTheCurve) {
  const auto below = grey(std::vector<float>(256, -4.0f)), black = grey(std::vector<float>(256, 0.0f));
  EXPECT_GT(flip_mean(hdr_flip_map(black, below, 16, 16, {0, 0, 1}), 16, 16), 0.5);
}

TEST(HdrFlip, ParsesExposures) {
  const auto range = parse_exposure_range("-4,4.5,9");
  ASSERT_TRUE(range);
  EXPECT_EQ(*range, (ExposureRange{-4, 4.5, 9}));
  for (const char* bad :
       {"", "1", "1,2", "a,2,3", "2,1,3", "1,2,0", "1,2,1", "1,2,3.5", "nan,2,3", "1,inf,3", "1,2,3,4", "0,1,100000"}) {
    const auto parsed = parse_exposure_range(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_EQ(parsed.error().kind, ErrorKind::usage);
  }
}

}  // namespace
}  // namespace candela::metrics_hdr_flip
