#include "reference/sampling.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "reference/brdf.h"
#include "reference/sky.h"
#include "scene/studio.h"

namespace candela::reference {
namespace {

using std::numbers::pi;

// The points of one half of the samples, in the two dimensions that follow each other from `dimension`.
std::vector<glm::dvec2> points_of(int count, uint32_t dimension, uint64_t half) {
  std::vector<glm::dvec2> points;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 3, 5, uint64_t(i) * 2 + half);
    stream.start(dimension);
    points.push_back(stream.next2());
  }
  return points;
}

}  // namespace

TEST(Sampling, UniformGridsAreTheThesisOnes) {
  EXPECT_EQ(grid_of(4), glm::ivec2(2, 2));
  EXPECT_EQ(grid_of(8), glm::ivec2(4, 2));
  EXPECT_EQ(grid_of(16), glm::ivec2(4, 4));
  EXPECT_EQ(grid_of(1), glm::ivec2(1, 1));
  EXPECT_EQ(grid_of(7), glm::ivec2(7, 1));
  std::set<std::pair<double, double>> seen;
  for (uint64_t i = 0; i < 8; ++i) {
    const glm::dvec2 p = SampleStream({SamplerKind::uniform, 8, 0}, 10, 20, i).pixel();
    seen.insert({p.x, p.y});
  }
  std::set<std::pair<double, double>> expected;
  for (const double x : {0.125, 0.375, 0.625, 0.875})
    for (const double y : {0.25, 0.75}) expected.insert({x, y});
  EXPECT_EQ(seen, expected);
}

TEST(Sampling, JitteredPutsOnePointInEachCell) {
  std::set<std::pair<int, int>> cells;
  bool off_centre = false;
  for (uint64_t i = 0; i < 16; ++i) {
    const glm::dvec2 p = SampleStream({SamplerKind::jittered, 16, 0}, 1, 2, i).pixel();
    ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
    cells.insert({int(p.x * 4), int(p.y * 4)});
    off_centre |= std::abs(p.x * 4 - int(p.x * 4) - 0.5) > 0.1;
  }
  EXPECT_EQ(cells.size(), 16u);
  EXPECT_TRUE(off_centre);
}

// Of the first 16 points of a (0, 2)-sequence every elementary interval of area 1/16 holds one: squares, rows, columns,
// and between.
TEST(Sampling, SobolIsStratifiedInEveryElementaryInterval) {
  for (const uint32_t dimension : {0u, 4u, 16u, 40u})
    for (const uint64_t half : {0, 1}) {
      const std::vector<glm::dvec2> points = points_of(16, dimension, half);
      for (const auto& [columns, rows] : {std::pair(4, 4), {16, 1}, {1, 16}, {8, 2}, {2, 8}}) {
        std::set<std::pair<int, int>> cells;
        for (const glm::dvec2 p : points) cells.insert({int(p.x * columns), int(p.y * rows)});
        EXPECT_EQ(cells.size(), 16u) << dimension << " " << half << " " << columns << "x" << rows;
      }
    }
}

// All four dimensions of a group are stratified one by one, and groups differ.
TEST(Sampling, EveryDimensionIsStratified) {
  for (uint32_t dimension = 4; dimension < 24; ++dimension) {
    std::set<int> cells;
    for (uint64_t i = 0; i < 64; i += 2) {
      SampleStream stream({}, 0, 0, i);
      stream.start(dimension);
      cells.insert(int(stream.next() * 32));
    }
    EXPECT_EQ(cells.size(), 32u) << dimension;
  }
  EXPECT_NE(points_of(4, 4, 0), points_of(4, 8, 0));
}

TEST(Sampling, PixelsHalvesAndSeedsDiffer) {
  const auto pixel = [](uint64_t seed, int x, int y, uint64_t sample) {
    return SampleStream({SamplerKind::sobol, 16, seed}, x, y, sample).pixel();
  };
  std::set<double> seen;
  for (const uint64_t seed : {0, 1})
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        for (uint64_t i = 0; i < 4; ++i) seen.insert(pixel(seed, x, y, i).x);
  EXPECT_EQ(seen.size(), 72u);
  EXPECT_EQ(pixel(7, 1, 2, 3), pixel(7, 1, 2, 3));
}

// Dimensions know nothing of each other: the same sample of many pixels has no correlation between any two of them.
TEST(Sampling, DimensionsAreIndependent) {
  constexpr int side = 64, dimensions = 8;
  double products[dimensions][dimensions] = {};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      SampleStream stream({}, x, y, 2);
      stream.start(4);
      double value[dimensions];
      for (double& v : value) v = stream.next() - 0.5;
      for (int i = 0; i < dimensions; ++i)
        for (int j = 0; j < i; ++j) products[i][j] += value[i] * value[j] / (side * side);
    }
  // The standard deviation of such a mean is 1/12/64 = 0.0013.
  for (int i = 0; i < dimensions; ++i)
    for (int j = 0; j < i; ++j) EXPECT_NEAR(products[i][j], 0, 0.0065) << i << " " << j;
}

namespace {

// All directions of a sphere in cells of equal solid angle.
template <class F>
double integral_over_sphere(int rows, F&& f) {
  double sum = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < 2 * rows; ++j) {
      const double y = 1 - 2 * (i + 0.5) / rows, longitude = pi * (j + 0.5) / rows, r = std::sqrt(1 - y * y);
      sum += f(glm::dvec3(r * std::cos(longitude), y, r * std::sin(longitude)));
    }
  return sum * 4 * pi / (2.0 * rows * rows);
}

DecodedImage test_sky() {
  DecodedImage image;
  image.width = 16, image.height = 8;
  image.format = DecodedImage::Format::rgba32f;
  std::vector<float> texels(16 * 8 * 4, 0.0f);
  for (size_t i = 0; i < 128; ++i)
    for (size_t c = 0; c < 3; ++c)
      texels[i * 4 + c] = i % 16 < 6 ? 0.0f : float(0.1 + 0.01 * double(i % 7) * double(c + 1));
  texels[(2 * 16 + 3) * 4] = 40;  // a red sun in the dark part
  image.pixels.assign(reinterpret_cast<const std::byte*>(texels.data()),
                      reinterpret_cast<const std::byte*>(texels.data() + texels.size()));
  return image;
}

// Samples are of unit length and have the density that pdf() says, and their estimate is the sky's red.
void expect_samples_of_its_light(const Sky& sky) {
  const double red = integral_over_sphere(512, [&](glm::dvec3 d) { return sky.radiance(d).x; });
  double estimate = 0;
  constexpr int count = 1 << 14;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 0, 0, uint64_t(i));
    const Sky::Choice choice = sky.sample(stream.next2());
    ASSERT_NEAR(glm::length(choice.direction), 1, 1e-12);
    ASSERT_NEAR(choice.pdf, sky.pdf(choice.direction), 1e-9 * choice.pdf);
    estimate += sky.radiance(choice.direction).x / choice.pdf / count;
  }
  EXPECT_NEAR(estimate, red, 5e-3 * red);
}

}  // namespace

TEST(Sampling, TheSkysDensityIntegratesToOneAndCoversItsLight) {
  const Sky sky(test_sky());
  EXPECT_NEAR(integral_over_sphere(256, [&](glm::dvec3 d) { return sky.pdf(d); }), 1, 1e-2);
  EXPECT_NEAR(
      integral_over_sphere(256, [&](glm::dvec3 d) { return sky.radiance(d).x > 0 && !(sky.pdf(d) > 0) ? 1.0 : 0.0; }),
      0, 1e-12);
  expect_samples_of_its_light(sky);
}

// A constant sky's every direction is as likely as any other; the neutral one's mean is its constant.
TEST(Sampling, SkiesInClosedForm) {
  const Sky grey = Sky::constant(glm::dvec3(0.5));
  EXPECT_NEAR(grey.pdf(glm::normalize(glm::dvec3(1, 2, 3))), 1 / (4 * pi), 1e-12);
  const Sky neutral = Sky::neutral();
  EXPECT_NEAR(integral_over_sphere(128, [&](glm::dvec3 d) { return neutral.radiance(d).x; }), 4 * pi * 0.45, 1e-9);
  EXPECT_NEAR(neutral.radiance({0, 1, 0}).x, 0.7, 1e-12);
}

// The studio's samples have the density that pdf() says, and its radiance is the formula's, turned and multiplied.
TEST(Sampling, TheStudioIsSampledByItsLight) {
  const Sky studio = Sky::studio(), turned = Sky::studio(pi / 2, 2);
  EXPECT_NEAR(integral_over_sphere(256, [&](glm::dvec3 d) { return studio.pdf(d); }), 1, 1e-2);
  expect_samples_of_its_light(studio);
  const glm::dvec3 d = glm::normalize(glm::dvec3(0.5, 0.7, 0.4));
  EXPECT_NEAR(turned.radiance({d.z, d.y, -d.x}).x, 2 * studio_radiance(d), 1e-12);
}

// A unit vector's rounding may take it past the poles.
// Turned a quarter counter-clockwise seen from above, what was at +X is at -Z; its samples follow it.
TEST(Sampling, ASkyTurnsWithItsSamples) {
  const Sky sky(test_sky()), turned(test_sky(), std::numbers::pi / 2, 2);
  SampleStream stream({}, 3, 5, 7);
  for (int i = 0; i < 64; ++i) {
    const glm::dvec2 u = stream.next2();
    const Sky::Choice one = sky.sample(u), other = turned.sample(u);
    EXPECT_LT(glm::length(other.direction - glm::dvec3(one.direction.z, one.direction.y, -one.direction.x)), 1e-9);
    EXPECT_NEAR(other.pdf, one.pdf, 1e-6 * one.pdf);
    EXPECT_LT(glm::length(turned.radiance(other.direction) - 2.0 * sky.radiance(one.direction)), 1e-6);
  }
}

TEST(Sampling, ASkysPolesAreFinite) {
  const Sky sky(test_sky());
  const double beyond = std::nextafter(1.0, 2.0);
  for (const double y : {-beyond, beyond}) EXPECT_EQ(sky.radiance({0, y, 0}), sky.radiance({0, y < 0 ? -1 : 1, 0}));
}

TEST(Sampling, CosineDirectionsHaveTheirMean) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(-1, 2, -0.5));
  glm::dvec3 sum(0);
  constexpr int count = 4096;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 1, 1, uint64_t(i));
    const glm::dvec3 d = cosine_direction(n, stream.next2());
    ASSERT_GT(glm::dot(d, n), 0);
    sum += d;
  }
  EXPECT_LT(glm::length(sum / double(count) - n * (2.0 / 3)), 2e-3);
}

}  // namespace candela::reference
