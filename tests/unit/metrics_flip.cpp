#include <gtest/gtest.h>

#include "metrics/compare.h"
#include "metrics/flip.h"

namespace candela::metrics_flip {
namespace {

const std::filesystem::path flip_folder = CANDELA_SOURCE_DIR "/../shared/flip";

std::vector<Plane> flat(float r, float g, float b, size_t count) {
  return {Plane(count, r), Plane(count, g), Plane(count, b)};
}

// Flat images have no features, and filtering leaves them as they are, so FLIP is the remapped colour distance alone.
TEST(Flip, FlatImagesGiveTheColourDistance) {
  const int width = 24, height = 16;
  const size_t count = size_t(width) * size_t(height);
  const auto mean = [&](const std::vector<Plane>& a, const std::vector<Plane>& b) {
    return flip_mean(flip_map(a, b, width, height), width, height);
  };
  EXPECT_EQ(mean(flat(0.2f, 0.5f, 0.7f, count), flat(0.2f, 0.5f, 0.7f, count)), 0.0);
  EXPECT_NEAR(mean(flat(0, 1, 0, count), flat(0, 0, 1, count)), 1.0, 1e-4);  // the largest distance by definition
  // Black against white: lightness differs by 100, chroma by nothing. With the Hunt-adjusted distance of green and blue
  // D = |87.7370 - 32.3026| + |(-0.8773*86.1846, 0.8773*83.1812) - (0.3230*79.1975, -0.3230*107.8502)| in CIELAB, the
  // error is 0.95 + 0.05 * (100^0.7 - 0.4 D^0.7) / (0.6 D^0.7).
  const double distance =
      55.4344 + std::hypot(-0.877370 * 86.1846 - 0.323026 * 79.1975, 0.877370 * 83.1812 + 0.323026 * 107.8502);
  const double largest = std::pow(distance, 0.7);
  const double expected = 0.95 + 0.05 * (std::pow(100, 0.7) - 0.4 * largest) / (0.6 * largest);
  EXPECT_NEAR(mean(flat(0, 0, 0, count), flat(1, 1, 1, count)), expected, 2e-4);
}

// A lone white pixel on black: the published filters spread it, and the map is symmetric about it.
TEST(Flip, MapIsSymmetricAboutAPointAndInItsImages) {
  const int size = 41;
  std::vector<Plane> black = flat(0, 0, 0, size * size), point = black;
  for (Plane& plane : point) plane[20 * size + 20] = 1;
  const Plane map = flip_map(black, point, size, size), swapped = flip_map(point, black, size, size);
  EXPECT_EQ(map, swapped);
  // Values of this implementation while it agreed with the authors' three means to six digits: they hold where the
  // authors' images are absent.
  EXPECT_NEAR(map[20 * size + 20], 0.864899, 1e-4);
  EXPECT_NEAR(map[20 * size + 22], 0.480556, 1e-4);
  EXPECT_EQ(map[0], 0.0f);
  // The powers 0.7 and 0.5 lift the last bits of the two filter orders to 5e-5 where nothing differs.
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      EXPECT_NEAR(map[size_t(y * size + x)], map[size_t(y * size + size - 1 - x)], 2e-4);
      EXPECT_NEAR(map[size_t(y * size + x)], map[size_t(x * size + y)], 2e-4);
    }
}

struct Published {
  const char* name;
  double mean;
};
class FlipPublished : public testing::TestWithParam<Published> {};

// EXPECTED.tsv beside the images: the mean by the authors' program.
TEST_P(FlipPublished, MeanIsTheAuthors) {
  const auto& [name, mean] = GetParam();
  if (!std::filesystem::exists(flip_folder)) GTEST_SKIP() << "the folder shared/flip is absent";
  const auto result =
      compare_files(flip_folder / (std::string(name) + "_ref.png"), flip_folder / (std::string(name) + "_test.png"));
  ASSERT_TRUE(result.has_value()) << result.error().text();
  ASSERT_EQ(result->refusal, "");
  EXPECT_NEAR(result->metrics.at("flip"), mean, 5e-6);
  RecordProperty("flip", fmt::format("{:.6f}", result->metrics.at("flip")));
}
INSTANTIATE_TEST_SUITE_P(Authors, FlipPublished,
                         testing::Values(Published{"AlphaBlendModeTest", 0.090073},
                                         Published{"CesiumMilkTruck", 0.033521}, Published{"FlightHelmet", 0.064896}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace candela::metrics_flip
