// Where rays of the reference meet a relief: planes and ramps by their formulas, hills by a march of tiny steps.
#include "reference/relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/rng.h"

namespace candela::reference {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Texture heights(int width, int height, const std::function<double(int, int)>& of) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 1, {}};
  std::vector<float> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.insert(texels.end(), 4, float(of(x, y)));
  const auto bytes = std::as_bytes(std::span(texels));
  image.pixels.assign(bytes.begin(), bytes.end());
  return Texture(std::move(image), false);
}

// Two units of the plane z = 0 as one triangle, with texture coordinates from 0 to 1 over the unit square.
struct Case {
  Texture texture;
  TextureSlot slot;
  Sampler sampler;
  ReliefLayer layer;
  Case(Texture t, double depth, Wrap wrap = Wrap::clamp) : texture(std::move(t)) {
    sampler.wrap_u = sampler.wrap_v = wrap;
    layer.edge[0] = {2, 0, 0}, layer.edge[1] = {0, 2, 0}, layer.below = {0, 0, -depth};
    layer.uv_edge[0] = {2, 0}, layer.uv_edge[1] = {0, 2};
    layer.most_uv = {1, 1};
    layer.heights = &texture, layer.slot = &slot, layer.sampler = &sampler;
  }
};

TEST(ReferenceRelief, AnEvenHeightIsAPlane) {
  Case c(heights(4, 4, [](int, int) { return 0.25; }), 0.8);
  const auto met = meet_relief(c.layer, {0.2, 0.3, 2}, {0.1, 0.05, -1}, 0, endless);
  ASSERT_TRUE(met);
  EXPECT_NEAR(met->t, 2.2, 1e-14);
  EXPECT_NEAR(met->weights.x, (0.2 + 0.22) / 2, 1e-14);
}

TEST(ReferenceRelief, ARampIsMetWhereItsPlaneIs) {
  // Clamped, so that it is even beyond the middles of the last texels.
  Case c(heights(8, 1, [](int x, int) { return x / 8.0; }), 0.5);
  const auto met = meet_relief(c.layer, {0.1, 0.5, 1}, {0.3, 0, -1}, 0, endless);
  ASSERT_TRUE(met);
  // z = -0.5 (8 u - 0.5) / 8 and z = 1 - t, u = 0.1 + 0.3 t.
  EXPECT_NEAR(met->t, (1 + 0.5 * (0.8 - 0.5) / 8) / (1 - 0.5 * 2.4 / 8), 1e-12);
}

TEST(ReferenceRelief, IsWhatAMarchOfTinyStepsFinds) {
  Rng rng(7);
  std::vector<double> texels(64);
  for (double& h : texels) h = rng.uniform(0, 1);
  Case c(heights(8, 8, [&](int x, int y) { return texels[size_t(8 * y + x)]; }), 0.3, Wrap::repeat);
  int hits = 0, misses = 0;
  for (int i = 0; i < 400; ++i) {
    c.layer.ends = i % 2 == 0;
    const glm::dvec3 on(rng.uniform(0, 1), rng.uniform(0, 1), 0);
    const glm::dvec3 d(rng.uniform(-2, 2), rng.uniform(-2, 2), -rng.uniform(0.05, 1)), from = on - d;
    const auto met = meet_relief(c.layer, from, d, 0, endless);
    std::optional<double> t;
    constexpr int steps = 40000;
    const double through = 0.3 / -d.z;
    for (int k = 0; k <= steps && !t; ++k) {
      const double s = through * k / steps;
      const glm::dvec3 p = on + s * d;
      if (c.layer.ends && (p.x < 0 || p.y < 0 || p.x > 1 || p.y > 1)) break;
      if (-p.z / 0.3 >= c.layer.height(glm::dvec2(p) / 2.0)) t = 1 + s;
    }
    ASSERT_EQ(met.has_value(), t.has_value()) << i;
    if (!t) {
      ++misses;
      continue;
    }
    ++hits;
    EXPECT_LE(met->t, *t + 1e-12) << i;
    EXPECT_GE(met->t, *t - through / steps - 1e-12) << i;
    EXPECT_NEAR(met->depth, c.layer.height(met->weights), 1e-9) << i;
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 20);
}

TEST(ReferenceRelief, ARayThatBeginsInsideHasToComeOutFirst) {
  // A wall of height 0 between floors of height 1.
  Case c(heights(9, 1, [](int x, int) { return x == 4 ? 0.0 : 1.0; }), 1);
  const glm::dvec3 on_floor(0.2, 0.5, -1);
  EXPECT_FALSE(meet_relief(c.layer, on_floor, {0, 0, 1}, 1e-6, endless)) << "up and out";
  const auto wall = meet_relief(c.layer, on_floor, {1, 0, 0.2}, 1e-6, endless);
  ASSERT_TRUE(wall);
  EXPECT_GT(wall->t, 0.15);
  EXPECT_LT(wall->t, 0.3);
  EXPECT_FALSE(meet_relief(c.layer, on_floor, {1, 0, 8}, 1e-6, endless)) << "over it";
}

TEST(ReferenceRelief, FromBehindTheFloorIsMet) {
  Case c(heights(2, 2, [](int, int) { return 0.5; }), 0.4);
  const auto met = meet_relief(c.layer, {0.5, 0.5, -2}, {0, 0, 1}, 0, endless);
  ASSERT_TRUE(met);
  EXPECT_NEAR(met->t, 1.6, 1e-14);
  EXPECT_EQ(met->depth, 1);
}

TEST(ReferenceRelief, ATriangleWithoutAreaOrDepthHasNone) {
  Case c(heights(2, 2, [](int, int) { return 0.5; }), 0);
  EXPECT_FALSE(meet_relief(c.layer, {0, 0, 1}, {0, 0, -1}, 0, endless));
  c.layer.below = {0, 0, -1}, c.layer.edge[1] = c.layer.edge[0];
  EXPECT_FALSE(meet_relief(c.layer, {0, 0, 1}, {0, 0, -1}, 0, endless));
}

TEST(ReferenceRelief, NormalsAreThoseOfTheSurface) {
  Rng rng(3);
  std::vector<double> texels(16);
  for (double& h : texels) h = rng.uniform(0, 1);
  Case c(heights(4, 4, [&](int x, int y) { return texels[size_t(4 * y + x)]; }), 0.3);
  for (int i = 0; i < 50; ++i) {
    const glm::dvec2 at(rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.4));
    const double step = 1e-7;
    const auto place = [&](glm::dvec2 w) { return c.layer.position(w, c.layer.height(w)); };
    const glm::dvec3 across = place(at + glm::dvec2(step, 0)) - place(at - glm::dvec2(step, 0)),
                     along = place(at + glm::dvec2(0, step)) - place(at - glm::dvec2(0, step));
    const glm::dvec3 normal = glm::normalize(c.layer.leaned({0, 0, 1}, c.layer.slope(at, false)));
    EXPECT_NEAR(glm::dot(normal, glm::normalize(across)), 0, 1e-5);
    EXPECT_NEAR(glm::dot(normal, glm::normalize(along)), 0, 1e-5);
    EXPECT_GT(normal.z, 0);
  }
}

}  // namespace
}  // namespace candela::reference
