#include "scene/studio.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "reference/display.h"
#include "scene/environment.h"

namespace candela {
namespace {

using std::numbers::pi;

// 0 to 255, as PNG shows a grey by default.
double code_of(double radiance) {
  return 255 *
         reference::display_encoded(reference::tone_mapped("agx", glm::dvec3(radiance), -12.47393, 4.026069), "agx").x;
}

struct Direction {
  glm::dvec3 towards;
  double solid_angle;
};
std::vector<Direction> directions(int width) {
  std::vector<Direction> all;
  const int height = width / 2;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      all.push_back({equirect_direction((x + 0.5) / width, (y + 0.5) / height),
                     2 * pi / width * (std::cos(pi * y / height) - std::cos(pi * (y + 1) / height))});
  return all;
}

// A white matte sphere and one of chrome, seen from the front: the first is bright and nowhere burnt out, the second
// shows boxes brighter than white before something dark.
TEST(Studio, ShowsWhiteAsWhiteAndChromeWithShapes) {
  const std::vector<Direction> sky = directions(160);
  constexpr int size = 24;
  double codes = 0, brightest = 0, dark = 0, boxes = 0, count = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) / size * 2 - 1, v = 1 - (y + 0.5) / size * 2;
      if (u * u + v * v >= 1) continue;
      const glm::dvec3 normal(u, v, std::sqrt(1 - u * u - v * v));
      double reflected = 0;
      for (const Direction& d : sky)
        reflected += std::max(glm::dot(normal, d.towards), 0.0) * studio_radiance(d.towards) * d.solid_angle / pi;
      codes += code_of(reflected), brightest = std::max(brightest, code_of(reflected));
      const double mirrored = studio_radiance(2 * normal.z * normal - glm::dvec3(0, 0, 1));
      dark += code_of(mirrored) < 60, boxes += mirrored >= 1, ++count;
    }
  EXPECT_GE(codes / count, 190);
  EXPECT_LE(codes / count, 205);
  EXPECT_LT(brightest, 250);
  EXPECT_GE(dark / count, 1.0 / 3);
  EXPECT_GE(boxes / count, 0.1);
}

// Texels are means of the formula: light is kept, and none is black.
TEST(Studio, ItsImageIsTheFormulas) {
  const DecodedImage image = studio_image(128, 64);
  double of_image = 0, of_formula = 0;
  for (const Direction& d : directions(512)) of_formula += studio_radiance(d.towards) * d.solid_angle;
  const std::vector<Direction> texels = directions(128);
  for (size_t i = 0; i < texels.size(); ++i) {
    float texel[4];
    std::memcpy(texel, image.pixels.data() + i * 16, 16);
    EXPECT_GE(texel[0], 0.03f);
    EXPECT_EQ(texel[0], texel[2]);
    of_image += double(texel[0]) * texels[i].solid_angle;
  }
  EXPECT_NEAR(of_image, of_formula, 1e-3 * of_formula);
}

}  // namespace
}  // namespace candela
