#include "render/contact_sheet.h"

#include <gtest/gtest.h>

#include <cmath>

namespace candela {
namespace {

SheetPicture checks(int width, int height, const std::string& caption) {
  SheetPicture picture{std::vector<std::vector<float>>(3, std::vector<float>(size_t(width) * size_t(height))), width,
                       height, caption};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c) picture.planes[c][size_t(y) * size_t(width) + size_t(x)] = float((x + y) % 2);
  return picture;
}

int pixel(const DisplayImage& image, int x, int y) {
  return int(image.pixels[(size_t(y) * size_t(image.width) + size_t(x)) * 3]);
}

// Half black, half white is the grey that gives half the light: sRGB code 188, not 128.
TEST(ContactSheet, ShrinksInLinearLight) {
  const std::vector<SheetPicture> pictures = {checks(160, 80, "a")};
  const DisplayImage sheet = contact_sheet(pictures, {.columns = 1, .tile_width = 20, .tile_height = 10});
  EXPECT_EQ(pixel(sheet, 8, 8), 188);
  EXPECT_EQ(pixel(sheet, 27, 17), 188);
  EXPECT_EQ(pixel(sheet, 28, 17), 24);
}

TEST(ContactSheet, KeepsSmallPicturesAndOrder) {
  std::vector<SheetPicture> pictures;
  for (int i = 0; i < 5; ++i) {
    pictures.push_back(checks(2, 2, "p"));
    for (auto& plane : pictures.back().planes) std::fill(plane.begin(), plane.end(), float(i + 1) / 5);
  }
  const DisplayImage sheet = contact_sheet(pictures, {.columns = 3, .tile_width = 10, .tile_height = 10});
  EXPECT_EQ(sheet.width, 3 * 18 + 8);
  const int step_y = (sheet.height - 8) / 2;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(pixel(sheet, 8 + i % 3 * 18 + 4, 8 + i / 3 * step_y + 4), 51 * (i + 1)) << i;
}

TEST(ContactSheet, ACheckerShowsWhereAPictureIsTransparent) {
  SheetPicture picture = checks(32, 16, "");
  for (auto& plane : picture.planes) std::fill(plane.begin(), plane.end(), 0.0f);
  picture.alpha.assign(32 * 16, 0.0f);
  for (int y = 0; y < 16; ++y) picture.alpha[size_t(y) * 32] = 1;
  DisplayImage sheet = contact_sheet(std::vector{picture}, {.columns = 1, .tile_width = 32, .tile_height = 16});
  EXPECT_EQ(pixel(sheet, 8, 8), 0);
  EXPECT_EQ(pixel(sheet, 9, 8), 153);
  EXPECT_EQ(pixel(sheet, 8 + 8, 8), 102);
  EXPECT_EQ(pixel(sheet, 8 + 8, 8 + 8), 153);
  sheet = contact_sheet(std::vector{picture}, {.columns = 1, .tile_width = 16, .tile_height = 8});
  EXPECT_EQ(pixel(sheet, 8, 8), 77) << "half of it shows";
}

// A width that is no multiple of the new one: the mean stays.
TEST(ContactSheet, OddSizesKeepTheMean) {
  SheetPicture picture = checks(7, 5, "");
  const std::vector<SheetPicture> pictures = {picture};
  const DisplayImage sheet = contact_sheet(pictures, {.columns = 1, .tile_width = 3, .tile_height = 5});
  double sum = 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const double s = pixel(sheet, 8 + x, 8 + 1 + y) / 255.0;
      sum += (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4)) / 6;
    }
  EXPECT_NEAR(sum, 17.0 / 35, 0.01);
}

}  // namespace
}  // namespace candela
