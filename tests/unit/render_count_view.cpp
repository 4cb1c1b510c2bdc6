#include "render/count_view.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

TEST(CountView, ScaleEndsAtTheNextRoundNumber) {
  const auto scale = [](float largest) { return count_scale(std::array{0.0f, largest, 1.0f}); };
  EXPECT_EQ(scale(0), 1);
  EXPECT_EQ(scale(2), 2);
  EXPECT_EQ(scale(3), 5);
  EXPECT_EQ(scale(11), 20);
  EXPECT_EQ(scale(685), 1000);
}

TEST(CountView, ColoursGrowLighterAndSmallImagesHaveNoLegend) {
  std::vector<float> counts(16);
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = float(i);
  const DisplayImage image = count_view(counts, 16, 1);
  ASSERT_EQ(image.pixels.size(), 48u);
  int before = -1;
  for (size_t i = 0; i < 16; ++i) {
    const int sum = int(image.pixels[3 * i]) + int(image.pixels[3 * i + 1]) + int(image.pixels[3 * i + 2]);
    EXPECT_GT(sum, before) << i;
    before = sum;
  }
}

// The ramp's ends are the colours of 0 and of the scale's end, and white digits stand below.
TEST(CountView, TheLegendShowsTheScale) {
  const int width = 160, height = 90;
  std::vector<float> counts(size_t(width) * size_t(height), 7);
  const DisplayImage image = count_view(counts, width, height), all = count_view(std::vector<float>(4, 1), 2, 2);
  size_t white = 0;
  for (int y = 70; y < height; ++y)
    for (int x = 0; x < 60; ++x) {
      const size_t i = (size_t(y) * size_t(width) + size_t(x)) * 3;
      white += image.pixels[i] == std::byte(255) && image.pixels[i + 1] == std::byte(255) &&
               image.pixels[i + 2] == std::byte(255);
    }
  EXPECT_GT(white, 15u);
  EXPECT_NE(image.pixels[(size_t(height - 1) * size_t(width)) * 3], image.pixels[0]);  // the plate
  EXPECT_EQ(int(all.pixels[0]), 0xfc);
}

}  // namespace
}  // namespace candela
