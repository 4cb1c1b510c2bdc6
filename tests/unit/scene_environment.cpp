#include "scene/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

namespace candela {
namespace {

using std::numbers::pi;

DecodedImage make_environment(int width, int height, const std::function<glm::dvec3(glm::dvec3)>& radiance) {
  DecodedImage image;
  image.width = width;
  image.height = height;
  image.format = DecodedImage::Format::rgba32f;
  std::vector<float> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 c = radiance(equirect_direction((x + 0.5) / width, (y + 0.5) / height));
      texels.insert(texels.end(), {float(c.x), float(c.y), float(c.z), 1.0f});
    }
  image.pixels.resize(texels.size() * 4);
  std::memcpy(image.pixels.data(), texels.data(), image.pixels.size());
  return image;
}

// The mean radiance that a white diffuse surface reflects, from the coefficients: real spherical harmonics in double.
glm::dvec3 reflected(const AmbientSh& sh, glm::dvec3 n) {
  const double basis[] = {std::sqrt(1 / (4 * pi)),
                          std::sqrt(3 / (4 * pi)) * n.y,
                          std::sqrt(3 / (4 * pi)) * n.z,
                          std::sqrt(3 / (4 * pi)) * n.x,
                          std::sqrt(15 / (4 * pi)) * n.x * n.y,
                          std::sqrt(15 / (4 * pi)) * n.y * n.z,
                          std::sqrt(5 / (16 * pi)) * (3 * n.z * n.z - 1),
                          std::sqrt(15 / (4 * pi)) * n.x * n.z,
                          std::sqrt(15 / (16 * pi)) * (n.x * n.x - n.y * n.y)};
  glm::dvec3 sum(0);
  for (size_t i = 0; i < 9; ++i) sum += glm::dvec3(sh[i]) * basis[i];
  return sum;
}

// The same by summing the radiance over the sphere.
glm::dvec3 integrated(const std::function<glm::dvec3(glm::dvec3)>& radiance, glm::dvec3 n) {
  glm::dvec3 sum(0);
  const int rows = 400, columns = 800;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double polar = pi * (y + 0.5) / rows, longitude = 2 * pi * (x + 0.5) / columns;
      const glm::dvec3 d(std::sin(polar) * std::cos(longitude), std::cos(polar), std::sin(polar) * std::sin(longitude));
      sum += radiance(d) * std::max(glm::dot(n, d), 0.0) * std::sin(polar);
    }
  return sum * (pi / rows) * (2 * pi / columns) / pi;
}

const glm::dvec3 directions[] = {{1, 0, 0},  {-1, 0, 0},    {0, 1, 0},          {0, -1, 0},         {0, 0, 1},
                                 {0, 0, -1}, {0.6, 0.8, 0}, {0.48, -0.6, 0.64}, {-0.36, 0.48, -0.8}};

}  // namespace

TEST(Environment, AConstantOneReflectsItsOwnRadiance) {
  const auto sh = project_environment(make_environment(64, 32, [](glm::dvec3) { return glm::dvec3(2, 0.5, 7); }));
  // The basis is written with six digits, and the rows' centres stand for their areas.
  for (const glm::dvec3 n : directions) EXPECT_LT(glm::length(reflected(sh, n) / glm::dvec3(2, 0.5, 7) - 1.0), 2e-3);
  const auto fine = project_environment(make_environment(512, 256, [](glm::dvec3) { return glm::dvec3(2, 0.5, 7); }));
  for (const glm::dvec3 n : directions) EXPECT_LT(glm::length(reflected(fine, n) / glm::dvec3(2, 0.5, 7) - 1.0), 5e-5);
}

// A cosine lobe about a tilted axis. The bands beyond l = 2 (l = 4 and up; l = 3 is zero) hold what the nine
// coefficients leave out: under 0.4 % of the peak here (Ramamoorthi and Hanrahan 2001).
TEST(Environment, AConstantOneOfOneTexelShinesFromAllSides) {
  const auto sh = project_environment(make_environment(1, 1, [](glm::dvec3) { return glm::dvec3(0.7); }));
  for (const glm::dvec3 n : directions) EXPECT_NEAR(reflected(sh, n).x, 0.7, 2e-3);
}

TEST(Environment, ACosineLobeAgreesWithNumericIntegration) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.5, 0.7, -0.4));
  const auto lobe = [&](glm::dvec3 d) { return glm::dvec3(3, 2, 1) * std::max(glm::dot(d, axis), 0.0); };
  const auto sh = project_environment(make_environment(256, 128, lobe));
  const double peak = integrated(lobe, axis).x;
  EXPECT_NEAR(peak, 3 * 2.0 / 3, 1e-3);  // the integral of cos^2 over pi
  for (const glm::dvec3 n : directions)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(reflected(sh, n)[c], integrated(lobe, n)[c], 0.004 * peak * (3 - c) / 3);
}

// What lies within l = 2 is kept exactly.
TEST(Environment, LinearAndQuadraticOnesAreExact) {
  const auto radiance = [](glm::dvec3 d) {
    return glm::dvec3(2 + d.x, 2 + d.y * d.z, 3 + d.z - d.x * d.x + 0.5 * d.x * d.y);
  };
  const auto sh = project_environment(make_environment(512, 256, radiance));
  for (const glm::dvec3 n : directions) EXPECT_LT(glm::length(reflected(sh, n) - integrated(radiance, n)), 5e-4);
}

TEST(Environment, TheMiddleIsPlusXAndTheTopPlusY) {
  const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
  EXPECT_TRUE(near(equirect_direction(0.5, 0.5), {1, 0, 0}));
  EXPECT_TRUE(near(equirect_direction(0.75, 0.5), {0, 0, 1}));
  EXPECT_TRUE(near(equirect_direction(0.25, 0.5), {0, 0, -1}));
  EXPECT_TRUE(near(equirect_direction(0.3, 0), {0, 1, 0}));
  EXPECT_TRUE(near(equirect_direction(0.3, 1), {0, -1, 0}));
}

// Turned, it is that of the turned sky: what lay at +X comes to -Z by a quarter counter-clockwise seen from above.
TEST(Environment, TurnsAboutTheVertical) {
  const auto radiance = [](glm::dvec3 d) {
    return glm::dvec3(2 + d.x, 2 + d.y * d.z + d.x * d.z, 3 + d.z - d.x * d.x + 0.5 * d.x * d.y);
  };
  const auto sh = project_environment(make_environment(512, 256, radiance));
  for (const double angle : {0.0, std::numbers::pi / 2, 2.2, -0.7}) {
    const AmbientSh now = turned(sh, angle, 1.5);
    for (const glm::dvec3 n : directions) {
      const double c = std::cos(angle), s = std::sin(angle);
      const glm::dvec3 before(c * n.x - s * n.z, n.y, s * n.x + c * n.z);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(reflected(now, n)[k], 1.5 * reflected(sh, before)[k], 1e-5) << angle;
    }
  }
  EXPECT_GT(reflected(turned(sh, std::numbers::pi / 2, 1), {0, 0, -1}).x, 2.5);
  EXPECT_EQ(turned(sh, 0, 1), sh);
}

TEST(Environment, TheNeutralOneIsBrighterAbove) {
  const AmbientSh sh = neutral_ambient();
  const double above = reflected(sh, {0, 1, 0}).x, below = reflected(sh, {0, -1, 0}).x,
               side = reflected(sh, {1, 0, 0}).x;
  EXPECT_GT(above, side);
  EXPECT_GT(below, 0.1);
  EXPECT_NEAR(side, (above + below) / 2, 1e-5);
  for (const glm::dvec3 n : directions) {
    EXPECT_EQ(reflected(sh, n).x, reflected(sh, n).y);
    EXPECT_NEAR(reflected(sh, n).x, side + n.y * (above - side), 1e-5);
  }
}

}  // namespace candela
