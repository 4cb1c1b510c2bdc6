#include "reference/display.h"

#include <gtest/gtest.h>

#include "reference_fixture.h"

namespace candela::reference::test {

TEST(Display, CurvesHitTheirKnownPoints) {
  // 0.18 is AgX's middle: half way up before the display's power of 2.2.
  EXPECT_NEAR(tone_mapped("agx", glm::dvec3(0.18)).x, std::pow(0.5, 2.2), 2e-3);
  EXPECT_NEAR(tone_mapped("agx", glm::dvec3(1e6)).x, 1, 1e-3);
  EXPECT_EQ(tone_mapped("reinhard", glm::dvec3(1)).x, 0.5);
  EXPECT_EQ(tone_mapped("rec709", glm::dvec3(1)).x, 0.5);
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

}  // namespace candela::reference::test
