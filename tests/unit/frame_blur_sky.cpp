// The blurred background: deviations below what floats tell directions apart, and a closed form above it.
#include "sky/blur_sky.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "scene/environment.h"

namespace candela::test::frame_blur_sky {
namespace {

constexpr int width = 64, height = 32;
glm::vec4 texel(const DecodedImage& image, int x, int y) {
  glm::vec4 t;
  std::memcpy(&t, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 16);
  return t;
}
DecodedImage sky_of(const std::function<glm::vec4(int x, int y)>& radiance) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  image.pixels.resize(size_t(width) * height * 16);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::vec4 t = radiance(x, y);
      std::memcpy(image.pixels.data() + (size_t(y) * width + size_t(x)) * 16, &t, 16);
    }
  return image;
}

TEST(BlurSky, LessThanATexelLeavesTheImageAsItIs) {
  const DecodedImage sky = sky_of([](int x, int y) { return glm::vec4(1 + x, 1 + y, 0.5f, 1); });
  // Down to deviations whose inverse squares are no floats.
  for (const double deviation : {1e-4, 1e-6, 1e-12, 1e-30, 1e-300}) {
    const DecodedImage blurred = blurred_sky(sky, deviation);
    ASSERT_EQ(blurred.width, width);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const glm::vec4 is = texel(blurred, x, y), was = texel(sky, x, y);
        for (int c = 0; c < 4; ++c) ASSERT_NEAR(is[c], was[c], 1e-5f * was[c]) << deviation << " " << x << " " << y;
      }
  }
}

// A texel in the pole's row has neighbours a twentieth of a row away: their fraction follows from the angle between.
TEST(BlurSky, SmallAnglesAreToldApart) {
  constexpr int bright = 20;
  const DecodedImage sky = sky_of([](int x, int y) { return glm::vec4(x == bright && y == 0 ? 1 : 0); });
  const double deviation = 2e-3, pi = std::numbers::pi;
  const DecodedImage blurred = blurred_sky(sky, deviation);
  const auto angle_to = [&](int columns) {  // between texels of the row next to the pole
    return 2 * std::asin(std::sin(pi * 0.5 / height) * std::sin(pi * columns / width));
  };
  double weights = 0;
  for (int k = -width / 2; k < width / 2; ++k)
    if (angle_to(std::abs(k)) <= 3.2 * deviation)
      weights += std::exp((std::cos(angle_to(k)) - 1) / deviation / deviation);
  for (const int k : {0, 1}) {
    const double expected = std::exp((std::cos(angle_to(k)) - 1) / deviation / deviation) / weights;
    EXPECT_NEAR(texel(blurred, bright + k, 0).x, expected, 2e-4 * expected) << k;
  }
}

}  // namespace
}  // namespace candela::test::frame_blur_sky
