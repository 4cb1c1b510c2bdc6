#include "reference/display.h"

#include <gtest/gtest.h>

#include "reference_fixture.h"

namespace candela::reference::test {

TEST(Display, CurvesHitTheirKnownPoints) {
  // 0.18 is AgX's middle: half way up before the display's power of 2.2.
  EXPECT_NEAR(tone_mapped("agx", glm::dvec3(0.18)).x, std::pow(0.5, 2.2), 2e-3);
  EXPECT_NEAR(tone_mapped("agx", glm::dvec3(1e6)).x, 1, 1e-3);
  EXPECT_EQ(tone_mapped("reinhard", glm::dvec3(1)).x, 0.5);
  EXPECT_EQ(tone_mapped("reinhard-luminance", glm::dvec3(1)).x, 0.5);
  // The Rec. 709 camera curve stands in the place of sRGB's: white stays white.
  const auto code_709 = [](double v) {
    return 255 * display_encoded(tone_mapped("rec709", glm::dvec3(v)), "rec709").x;
  };
  EXPECT_EQ(code_709(1), 255);
  EXPECT_NEAR(code_709(0.5), 179.90, 0.01);
  EXPECT_NEAR(code_709(0.01), 255 * 0.045, 1e-9);
  // Both fits of AgX leave greys alike; orange differs by some codes.
  const auto agx = [](const char* curve, glm::dvec3 c) {
    return 255.0 * display_encoded(tone_mapped(curve, c), curve);
  };
  EXPECT_NEAR(agx("agx-2020", glm::dvec3(0.18)).x, agx("agx", glm::dvec3(0.18)).x, 0.5);
  const glm::dvec3 orange(1, 0.4, 0.05), apart = glm::abs(agx("agx-2020", orange) - agx("agx", orange));
  EXPECT_GT(std::max({apart.x, apart.y, apart.z}), 4);
  EXPECT_LT(std::max({apart.x, apart.y, apart.z}), 30);
  EXPECT_NEAR(tone_mapped("neutral", glm::dvec3(0.5)).x, 0.46, 1e-12);
  EXPECT_LT(tone_mapped("neutral", glm::dvec3(100)).x, 1);
  EXPECT_EQ(tone_mapped("none", glm::dvec3(3)).x, 3);
}

TEST(Display, AlphaComesOutStraight) {
  GltfBuilder b = empty_scene();
  use_all(b);
  Json half = unlit_material(1, 0.5, 0, 0.5);
  half["alphaMode"] = "BLEND";
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, half))}});
  const TestCamera camera{.yfov_deg = 20, .width = 2, .height = 1};
  const Film film = traced(*make_world(b, camera), centred(), camera, 1);
  const DisplayImage image = display_image(film, {.curve = "none", .dither = false, .alpha = true});
  ASSERT_EQ(image.channels, 4);
  const auto code = [&](size_t i) { return std::to_integer<int>(image.pixels[i]); };
  EXPECT_EQ(code(0), 255);
  EXPECT_EQ(code(1), 188);  // sRGB of 0.5
  EXPECT_EQ(code(2), 0);
  EXPECT_EQ(code(3), 128);
  const DisplayImage wide = display_image(film, {.curve = "none", .exposure_ev = -1, .bits = 16, .alpha = true});
  EXPECT_EQ(wide.pixels.size(), 16u);
}

// The renderer's dither (shaders/tonemap.comp), number for number: PCG in three dimensions of pixel and seed (Jarzynski
// and Olano 2020), triangular noise of one code value either way.
TEST(Display, DitherIsThatOfTheRenderer) {
  const auto pcg3d = [](glm::uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
    return glm::dvec3(v >> 8u) / 16777216.0;
  };
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, unlit_material(0.6, 0.2, 0.05)))}});
  const TestCamera camera{.yfov_deg = 20, .width = 16, .height = 9};
  const Film film = traced(*make_world(b, camera), centred(), camera, 1);
  for (const uint32_t seed : {0u, 7u}) {
    const DisplayImage image = display_image(film, {.curve = "none", .seed = seed});
    ASSERT_EQ(image.pixels.size(), size_t(3 * 16 * 9));
    for (uint32_t y = 0; y < 9; ++y)
      for (uint32_t x = 0; x < 16; ++x) {
        const glm::dvec3 noise = pcg3d({x, y, seed}) - pcg3d({x, y, seed ^ 0x9e3779b9u});
        const double linear[] = {0.6, 0.2, 0.05};
        for (size_t c = 0; c < 3; ++c) {
          const double encoded = 255 * (1.055 * std::pow(linear[c], 1 / 2.4) - 0.055);
          EXPECT_EQ(std::to_integer<int>(image.pixels[(size_t(y) * 16 + x) * 3 + c]),
                    int(std::floor(encoded + noise[int(c)] + 0.5)))
              << x << " " << y << " channel " << c << " seed " << seed;
        }
      }
  }
}

// Greys through AgX: a toe of power 3 below the pivot, a shoulder of power 3.25 above it.
TEST(Display, AgxHasItsToeAndItsShoulder) {
  const double pivot = 10 / 16.5;
  for (const double x : {0.2, 0.4, 0.75, 0.9}) {
    const bool toe = x < pivot;
    const double power = toe ? 3 : 3.25, reach = toe ? pivot : 1 - pivot;
    const double scale = std::pow(std::pow(2 * reach, -power) * (std::pow(4 * reach, power) - 1), -1 / power);
    const double u = 2 * std::abs(x - pivot) / scale, y = scale * u / std::pow(1 + std::pow(u, power), 1 / power);
    const double grey = std::exp2(-12.47393 + x * (4.026069 + 12.47393));
    EXPECT_NEAR(tone_mapped("agx", glm::dvec3(grey)).x, std::pow(0.5 + (toe ? -y : y), 2.2), 1e-3) << x;
  }
}

}  // namespace candela::reference::test
