#include "render/count_view.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

TEST(CountView, ScaleEndsAtARoundNumberAboveNearlyAll) {
  const auto scale = [](float largest) { return count_scale(std::vector<float>(200, largest)).end; };
  EXPECT_EQ(scale(0), 1);
  EXPECT_EQ(scale(2), 2);
  EXPECT_EQ(scale(3), 4);
  EXPECT_EQ(scale(11), 20);
  EXPECT_EQ(scale(685), 800);
  EXPECT_FALSE(count_scale(std::vector<float>(200, 8)).cut);
}

// One pixel of a thousand, or empty ones, must not make the rest nearly black.
TEST(CountView, AFewLargeCountsDoNotDarkenTheRest) {
  std::vector<float> counts(1000, 5);
  counts[7] = 4000;
  for (size_t i = 100; i < 900; ++i) counts[i] = 0;
  const CountScale scale = count_scale(counts);
  EXPECT_EQ(scale.end, 6);
  EXPECT_TRUE(scale.cut);
  const DisplayImage image = count_view(counts, 1000, 1, "T");
  EXPECT_GT(int(image.pixels[0]), 200) << "5 of 6 is bright";
  EXPECT_EQ(int(image.pixels[3 * 7]), 0xfc) << "the colour of the end";
}

TEST(CountView, ColoursGrowLighterAndSmallImagesHaveNoLegend) {
  std::vector<float> counts(16);
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = float(i);
  const DisplayImage image = count_view(counts, 16, 1, "T");
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
  const DisplayImage image = count_view(counts, width, height, "LIGHTS"),
                     all = count_view(std::vector<float>(4, 1), 2, 2, "T");
  size_t white = 0;
  for (int y = 70; y < height; ++y)
    for (int x = 0; x < 60; ++x) {
      const size_t i = (size_t(y) * size_t(width) + size_t(x)) * 3;
      white += image.pixels[i] == std::byte(255) && image.pixels[i + 1] == std::byte(255) &&
               image.pixels[i + 2] == std::byte(255);
    }
  EXPECT_GT(white, 15u);
  // Another title is another picture, and no title leaves its place on the plate empty.
  EXPECT_NE(count_view(counts, width, height, "WASTE").pixels, image.pixels);
  EXPECT_NE(image.pixels[(size_t(height - 1) * size_t(width)) * 3], image.pixels[0]);  // the plate
  EXPECT_EQ(int(all.pixels[0]), 0xfc);
}

}  // namespace
}  // namespace candela
