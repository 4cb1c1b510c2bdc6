#include "render/view_picture.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "render/frame_layers.h"

namespace candela {
namespace {

using Rgb = std::array<int, 3>;

FloatImage row(std::vector<std::vector<float>> planes, int width) {
  FloatImage image;
  image.width = width, image.height = int(planes[0].size()) / width;
  for (std::vector<float>& plane : planes) image.channels.push_back({.name = "c", .f = std::move(plane)});
  return image;
}

Rgb at(const DisplayImage& picture, int x, int y = 0) {
  Rgb color{};
  for (size_t c = 0; c < 3; ++c)
    color[c] = int(picture.pixels[(size_t(y) * size_t(picture.width) + size_t(x)) * 3 + c]);
  return color;
}

constexpr Rgb black = {0, 0, 0}, magenta = {255, 0, 255};

TEST(ViewPicture, DirectionsAreCodesAroundTheMiddle) {
  const DisplayImage picture = layer_view(row({{1, 0, 0}, {0, -1, 0}, {0, 0, 0}}, 3), LayerForm::direction, "normal");
  EXPECT_EQ(at(picture, 0), (Rgb{255, 128, 128}));
  EXPECT_EQ(at(picture, 1), (Rgb{128, 0, 128}));
  EXPECT_EQ(at(picture, 2), black) << "nothing is there";
}

TEST(ViewPicture, SharesAreGreyAndColoursAreEncoded) {
  EXPECT_EQ(at(layer_view(row({{0.5f}}, 1), LayerForm::fraction, "shadow_sun"), 0), (Rgb{128, 128, 128}));
  EXPECT_EQ(at(layer_view(row({{0.5f}, {0.0f}, {2.0f}}, 1), LayerForm::color, "albedo"), 0), (Rgb{188, 0, 255}));
}

TEST(ViewPicture, NearIsBrightFarIsDarkAndNothingIsBlack) {
  const DisplayImage picture = layer_view(
      row({{1, 2, 3, background_depth_m, std::numeric_limits<float>::infinity()}}, 5), LayerForm::distance, "depth");
  const auto sum = [&](int x) { return at(picture, x)[0] + at(picture, x)[1] + at(picture, x)[2]; };
  EXPECT_GT(sum(0), sum(1));
  EXPECT_GT(sum(1), sum(2));
  EXPECT_EQ(at(picture, 3), black);
  EXPECT_EQ(at(picture, 4), black) << "the background at infinity";
}

TEST(ViewPicture, OneDistanceIsSeen) {
  const DisplayImage picture = layer_view(row({{4, 4, background_depth_m}}, 3), LayerForm::distance, "depth");
  EXPECT_NE(at(picture, 0), black);
  EXPECT_EQ(at(picture, 0), at(picture, 1));
  EXPECT_EQ(at(picture, 2), black);
}

TEST(ViewPicture, IdsHaveColoursOfTheirOwn) {
  FloatImage image{.width = 301, .height = 1};
  Channel channel{.name = "object_id", .type = ChannelType::uint32};
  for (uint32_t i = 0; i < 300; ++i) channel.u.push_back(i);
  channel.u.push_back(0xffffffffu);
  image.channels = {channel};
  const DisplayImage picture = layer_view(image, LayerForm::id, "object_id");
  std::set<Rgb> colors;
  for (int i = 0; i < 300; ++i) {
    colors.insert(at(picture, i));
    EXPECT_GT(at(picture, i)[0] + at(picture, i)[1] + at(picture, i)[2], 150) << i << " is no black";
  }
  EXPECT_EQ(colors.size(), 300u);
  EXPECT_EQ(at(picture, 300), black);
}

// Half of one id and half of nothing is half as bright as all of it.
TEST(ViewPicture, MattesAreIdsByTheirCoverage) {
  const float id = std::bit_cast<float>(0x3f123456u), other = std::bit_cast<float>(0x40765432u);
  const auto pixel = [&](float a, float share_a, float b, float share_b) {
    return at(layer_view(row({{a}, {share_a}, {b}, {share_b}}, 1), LayerForm::matte, "crypto_object"), 0);
  };
  const Rgb all = pixel(id, 1, 0, 0), half = pixel(id, 0.5f, 0, 0), both = pixel(id, 0.5f, other, 0.5f);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(half[c], all[c] / 2.0, 1) << c;
  EXPECT_NE(both, half);
  EXPECT_EQ(pixel(0, 0, 0, 0), black);
}

TEST(ViewPicture, MotionIsRedAndGreenAboutTheMiddle) {
  const DisplayImage picture = layer_view(row({{0, 4, -4}, {0, -2, 0}}, 3), LayerForm::motion, "motion");
  EXPECT_EQ(at(picture, 0), (Rgb{128, 128, 128}));
  EXPECT_EQ(at(picture, 1), (Rgb{255, 64, 128}));
  EXPECT_EQ(at(picture, 2), (Rgb{0, 128, 128}));
  const DisplayImage still = layer_view(row({{0}, {0}}, 1), LayerForm::motion, "motion");
  EXPECT_EQ(at(still, 0), (Rgb{128, 128, 128}));
}

TEST(ViewPicture, WhatIsNotFiniteIsMagenta) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  EXPECT_EQ(at(layer_view(row({{nan}, {0}, {0}}, 1), LayerForm::color, "albedo"), 0), magenta);
  EXPECT_EQ(at(layer_view(row({{nan, 1}}, 2), LayerForm::distance, "depth"), 0), magenta);
  EXPECT_EQ(at(image_view(row({{infinite, 1}}, 2), 2, 1, "a.b"), 0), magenta);
}

TEST(ViewPicture, AnImageOfAnotherSizeIsFittedWithBlackAround) {
  // Two texels wide and one high into 4x4: rows 1 and 2 show it.
  const DisplayImage picture = image_view(row({{1, 0}, {0, 1}, {0, 0}}, 2), 4, 4, "a.b");
  ASSERT_EQ(picture.width, 4);
  ASSERT_EQ(picture.height, 4);
  for (int x = 0; x < 4; ++x) {
    EXPECT_EQ(at(picture, x, 0), black);
    EXPECT_EQ(at(picture, x, 3), black);
    for (const int y : {1, 2}) EXPECT_EQ(at(picture, x, y), (x < 2 ? Rgb{255, 0, 0} : Rgb{0, 255, 0})) << x;
  }
}

TEST(ViewPicture, OneChannelIsMappedFromItsLeastToItsLargest) {
  const DisplayImage picture = image_view(row({{-3, 0, 5}}, 3), 3, 1, "a.b"),
                     other = image_view(row({{-6, 0, 10}}, 3), 3, 1, "a.b");
  EXPECT_EQ(picture.pixels, other.pixels) << "the same places in their ranges";
  EXPECT_NE(at(picture, 0), at(picture, 1));
  EXPECT_NE(at(picture, 1), at(picture, 2));
}

}  // namespace
}  // namespace candela
