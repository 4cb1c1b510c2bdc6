#include "plan/sun_cascades.h"

#include <gtest/gtest.h>

#include "base/rng.h"
#include "math/transforms.h"
#include "passes/shadows/sun_knobs.h"

namespace candela::frame_sun_cascades {
namespace {

View view_at(glm::dvec3 position, glm::dvec3 back, double tan_x = 0.9, double tan_y = 0.5) {
  View view;
  view.position = position;
  view.tan_x = tan_x, view.tan_y = tan_y;
  view.view_from_relative = glm::dmat4(glm::transpose(glm::dmat3(look_at_pose(back, glm::dvec3(0)))));
  return view;
}

// A world of that half size around the origin, as a camera sees it.
SunFit world_of(double half_m, const View& view, double farthest_m) {
  return {DAabb{glm::dvec3(-half_m) - view.position, glm::dvec3(half_m) - view.position}, 0, farthest_m};
}

glm::dvec3 random_direction(Rng& rng) {
  for (;;) {
    const glm::dvec3 d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (glm::length(d) > 0.1) return glm::normalize(d);
  }
}

// Where a point of relative space lies in a cascade, from its middle, in metres.
glm::dvec2 from_centre(const SunCascades& c, size_t cascade, glm::dvec3 relative) {
  return glm::dvec2(glm::dot(glm::dvec3(c.shadow.right), relative), glm::dot(glm::dvec3(c.shadow.up), relative)) -
         glm::dvec2(c.shadow.cascades[cascade].centre_m);
}
double farthest(glm::dvec2 v) { return std::max(std::abs(v.x), std::abs(v.y)); }

}  // namespace

TEST(SunCascades, SplitsFollowThePracticalScheme) {
  const auto uniform = cascade_splits(1, 101, 4, 0), logarithmic = cascade_splits(1, 16, 4, 1);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(uniform[size_t(i)], 26 + 25 * i, 1e-12);
    EXPECT_NEAR(logarithmic[size_t(i)], std::exp2(i + 1), 1e-12);
  }
  const auto mixed = cascade_splits(1, 16, 4, 0.9);
  EXPECT_NEAR(mixed[1], 0.9 * 4 + 0.1 * 8.5, 1e-12);
  EXPECT_EQ(mixed[3], 16);
}

TEST(SunCascades, SliceSpheresHoldTheirCornersAndTouchThem) {
  for (const double k : {0.3, 0.845, 1.0, 1.18, 2.5})
    for (const auto& [near_m, far_m] : {std::pair{0.01, 1.0}, {5.0, 15.0}, {14.0, 15.0}}) {
      const SliceSphere s = slice_sphere(near_m, far_m, k);
      const double to_near = std::hypot(s.depth_m - near_m, k * near_m),
                   to_far = std::hypot(far_m - s.depth_m, k * far_m);
      EXPECT_LE(to_near, s.radius_m * (1 + 1e-12));
      EXPECT_NEAR(to_far, s.radius_m, 1e-12 * s.radius_m);
      if (s.depth_m < far_m) {
        EXPECT_NEAR(to_near, s.radius_m, 1e-9 * s.radius_m) << "otherwise a smaller one would do";
      }
    }
}

TEST(SunCascades, AxesAreOrthonormalForEveryDirection) {
  Rng rng(41);
  std::vector<glm::dvec3> directions = {{0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, -1 + 1e-17}};
  for (int i = 0; i < 200; ++i) directions.push_back(random_direction(rng));
  for (const glm::dvec3 d : directions) {
    const glm::dmat3 axes = light_axes(d);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(glm::dot(axes[i], axes[j]), i == j ? 1 : 0, 1e-14);
    EXPECT_NEAR(glm::dot(glm::cross(axes[0], axes[1]), -d), 1, 1e-14);
  }
}

TEST(SunCascades, EveryPointOfASliceIsCoveredByItsCascadeOrAFinerOne) {
  Rng rng(42);
  for (const bool tight : {false, true})
    for (int trial = 0; trial < 40; ++trial) {
      const View view = view_at(random_direction(rng) * rng.uniform(0, 1e4), random_direction(rng),
                                rng.uniform(0.1, 1.5), rng.uniform(0.1, 1.5));
      SunKnobs knobs;
      knobs.tight = tight;
      const SunFit fit = world_of(1e5, view, 500);
      const SunCascades c = fit_sun_cascades(random_direction(rng), view, fit, knobs, 0);
      ASSERT_EQ(c.views.size(), 5u);
      for (int i = 0; i < 500; ++i) {
        const double depth = std::exp(rng.uniform(std::log(0.011), std::log(499)));
        const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));
        const glm::dvec3 point =
            axes * glm::dvec3(rng.uniform(-1, 1) * view.tan_x * depth, rng.uniform(-1, 1) * view.tan_y * depth, -depth);
        bool covered = false;
        for (size_t k = 0; k < 5; ++k)
          covered |= farthest(from_centre(c, k, point)) <= double(c.shadow.cascades[k].covered_m);
        EXPECT_TRUE(covered) << "depth " << depth;
        const double d = glm::dot(glm::dvec3(c.shadow.depth), point) + double(c.shadow.depth.w);
        EXPECT_GT(d, 0);
        EXPECT_LT(d, 1);
      }
    }
}

TEST(SunCascades, TexelsStayOnTheGroundAsTheCameraMoves) {
  Rng rng(43);
  for (const double away_m : {0.0, 1e6}) {
    const glm::dvec3 direction = random_direction(rng), back = random_direction(rng);
    const View before = view_at(glm::dvec3(away_m, -away_m / 3, 7), back);
    const SunCascades a = fit_sun_cascades(direction, before, world_of(1e8, before, 300), {}, 0);
    const glm::dmat3 axes = light_axes(direction);
    for (int step = 1; step <= 20; ++step) {
      View after = view_at(before.position + random_direction(rng) * rng.uniform(0, 3), random_direction(rng));
      const SunCascades b = fit_sun_cascades(direction, after, world_of(1e8, after, 300), {}, 0);
      const glm::dvec3 moved = glm::transpose(axes) * (after.position - before.position);
      for (size_t k = 0; k < 5; ++k) {
        ASSERT_EQ(a.shadow.cascades[k].texel_m, b.shadow.cascades[k].texel_m);
        const double texel_m = double(a.shadow.cascades[k].half_m) * 2 / 2048;
        const glm::dvec2 shift = (glm::dvec2(b.shadow.cascades[k].centre_m) + glm::dvec2(moved) -
                                  glm::dvec2(a.shadow.cascades[k].centre_m)) /
                                 texel_m;
        EXPECT_NEAR(shift.x, std::round(shift.x), 2e-3) << "cascade " << k << ", " << away_m << " m away";
        EXPECT_NEAR(shift.y, std::round(shift.y), 2e-3);
      }
    }
  }
}

// What rule A leaves out of a cascade lies where every receiver that it could darken takes a finer
// one: farther inside than the lookup of any point that does take this cascade reaches.
TEST(SunCascades, WhatAFinerCascadeServesIsOutOfReachOfItsOwnLookups) {
  Rng rng(44);
  for (int trial = 0; trial < 40; ++trial) {
    const View view = view_at(random_direction(rng) * 100.0, random_direction(rng));
    const SunCascades c = fit_sun_cascades(random_direction(rng), view, world_of(1e5, view, 400), {}, 0);
    for (size_t k = 1; k < 5; ++k) {
      const shared::View& v = c.views[k];
      if ((v.flags & shared::view_has_served) == 0) continue;
      const shared::SunCascade &finer = c.shadow.cascades[k - 1], &own = c.shadow.cascades[k];
      for (int i = 0; i < 200; ++i) {
        const glm::dvec2 place = glm::dvec2(rng.uniform(-1, 1), rng.uniform(-1, 1)) * double(own.half_m);
        const glm::dvec3 point = glm::dvec3(c.shadow.right) * (place.x + double(own.centre_m.x)) +
                                 glm::dvec3(c.shadow.up) * (place.y + double(own.centre_m.y)) +
                                 glm::dvec3(c.shadow.to_light) * rng.uniform(-1e4, 1e4);
        bool served = true;
        for (const glm::vec4& p : v.served) served &= glm::dot(glm::dvec3(p), point) + double(p.w) > 0;
        if (!served) continue;
        const double from_edge = double(finer.covered_m) - farthest(from_centre(c, k - 1, point));
        EXPECT_GT(from_edge, lookup_reach_texels * double(own.texel_m) * 0.999);
      }
    }
  }
}

TEST(SunCascades, ASmallSceneTakesNoMoreThanItsOwnSize) {
  const View view = view_at({0, 0, 5}, {0, 0, 1});
  const SunCascades c = fit_sun_cascades(glm::normalize(glm::dvec3(0.2, -1, 0.1)), view,
                                         {DAabb{glm::dvec3(-1, -1, -6), glm::dvec3(1, 1, -4)}, 4, 6}, {}, 0);
  EXPECT_LT(c.shadow.cascades[4].half_m, 1.9f);
  SunKnobs single;
  single.mode = int(SunMode::single);
  const SunCascades one = fit_sun_cascades(glm::dvec3(0, -1, 0), view,
                                           {DAabb{glm::dvec3(-1, -1, -6), glm::dvec3(1, 1, -4)}, 4, 6}, single, 3);
  ASSERT_EQ(one.views.size(), 1u);
  EXPECT_EQ(one.views[0].layer, 3u);
  EXPECT_EQ(one.views[0].size_px, glm::uvec2(4096));
  EXPECT_NEAR(one.shadow.cascades[0].half_m, 1, 0.04);
  for (const double y : {-1.0, 1.0}) {
    const double d = glm::dot(glm::dvec3(one.shadow.depth), glm::dvec3(0, y, -5)) + double(one.shadow.depth.w);
    EXPECT_NEAR(d, y > 0 ? 1 : 0, 2e-3) << "the light's side is near";
  }
}

TEST(SunCascades, UnknownBoundsAreNoHindrance) {
  const double infinity = std::numeric_limits<double>::infinity();
  const View view = view_at({0, 2, 0}, {0, 0, 1});
  const SunCascades c = fit_sun_cascades(glm::dvec3(0, -1, 0), view,
                                         {DAabb{glm::dvec3(-infinity), glm::dvec3(infinity)}, 0, infinity}, {}, 0);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_TRUE(std::isfinite(c.shadow.cascades[k].half_m));
    for (const glm::vec4& p : c.views[k].planes) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z + p.w));
  }
}

}  // namespace candela::frame_sun_cascades
