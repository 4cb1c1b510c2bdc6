// The medium's closed forms against quadrature, and at ends where naive forms lose all digits.
#include "reference/medium.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/rng.h"
#include "reference/equi_angular.h"
#include "reference/sampling.h"

namespace candela::reference::test::reference_medium {
namespace {

using std::numbers::pi;

Fog falling(double falloff, double height = 0) {
  Fog fog;
  fog.extinction_per_m = fog.scattering_per_m = glm::dvec3(1);
  fog.falloff_per_m = falloff, fog.height_m = height;
  return fog;
}
glm::dvec3 direction(Rng& rng) {
  const double y = rng.uniform(-1, 1), longitude = rng.uniform(0, 2 * pi), r = std::sqrt(1 - y * y);
  return {r * std::cos(longitude), y, r * std::sin(longitude)};
}
template <class F>
double simpson(double from, double to, int steps, F&& f) {
  const double h = (to - from) / steps;
  double sum = f(from) + f(to);
  for (int i = 1; i < steps; ++i) sum += f(from + i * h) * (i % 2 ? 4 : 2);
  return sum * h / 3;
}

}  // namespace

TEST(Medium, LengthIsTheIntegralOfTheDensity) {
  Rng rng(3);
  for (const double falloff : {0.0, 1e-12, 1e-3, 0.1, 1.0, 20.723265836946411, 300.0})
    for (int i = 0; i < 60; ++i) {
      const double height = rng.uniform(-2, 2);
      const Medium medium(falling(falloff, height), {0, height, 0});
      glm::dvec3 d = direction(rng);
      if (i % 4 == 0) d = glm::normalize(glm::dvec3(d.x, i % 8 == 0 ? 0 : d.y * 1e-9, d.z));  // level, or all but
      const double level = falloff > 0 ? std::min(3 / falloff, 2.0) : 2;
      const glm::dvec3 origin(rng.uniform(-3, 3), rng.uniform(-1, 1) * level, rng.uniform(-3, 3));
      const double rate = falloff * std::abs(d.y), reach = rate > 0 ? std::min(20 / rate, 50.0) : 50;
      const Span span{rng.uniform(0, reach / 2), reach};
      const double expected =
          simpson(span.begin_m, span.end_m, 4000, [&](double t) { return medium.density(origin + d * t); });
      const double length = medium.length(origin, d, span);
      EXPECT_NEAR(length, expected, 1e-8 * expected) << falloff << " " << d.y;
      // And back: where a part of the length is reached.
      for (const double part : {1e-9, 0.3, 0.999}) {
        const double at = medium.distance_at(origin, d, span.begin_m, part * length);
        EXPECT_NEAR(medium.length(origin, d, {span.begin_m, at}), part * length,
                    1e-7 * part * length + 1e-13 * medium.density(origin + d * at));
      }
    }
}

TEST(Medium, IsFiniteWhereNaiveFormsAreNot) {
  EXPECT_EQ(one_minus_exp_over(0), 1);
  EXPECT_EQ(one_minus_exp_over(1e-300), 1);
  EXPECT_NEAR(one_minus_exp_over(1e-8), 1 - 5e-9, 1e-16);
  EXPECT_NEAR(one_minus_exp_over(1e-2), 1 - 1e-2 / 2 + 1e-4 / 6 - 1e-6 / 24, 1e-9);
  EXPECT_EQ(one_minus_exp_over(std::numeric_limits<double>::infinity()), 0);

  const double everything = std::numeric_limits<double>::infinity();
  for (const double falloff : {0.0, 1e-300, 1e-12, 1.0, 20.7, 1e6, 3e38})
    for (const double y : {0.0, 1e-30, 1.0, -1.0, 1e6, -1e6, 1e30, -1e30})
      for (const double slope : {0.0, 1e-300, -1e-300, 1e-9, -1e-9, 0.5, -0.5, 1.0, -1.0})
        for (const double end : {1e-9, 1.0, 1e30, everything})
          for (const double extinction : {0.0, 1e-8, 1e6}) {
            Fog fog = falling(falloff);
            fog.extinction_per_m = {extinction, 1, 0};
            const Medium medium(fog, {0, y, 0});
            const glm::dvec3 d(std::sqrt(1 - slope * slope), slope, 0), none(0);
            const double length = medium.length(none, d, {0, end});
            EXPECT_GE(length, 0) << falloff << " " << y << " " << slope << " " << end;
            const glm::dvec3 through = medium.through(length), held = medium.held(length);
            for (int c = 0; c < 3; ++c) {
              EXPECT_TRUE(through[c] >= 0 && through[c] <= 1)
                  << falloff << " " << y << " " << slope << " " << end << " " << extinction;
              EXPECT_NEAR(through[c] + held[c], 1, 1e-15);
            }
            EXPECT_EQ(through.z, 1) << "nothing is lost where there is no extinction";
            for (const double part : {1e-12, 1.0, 40.0})
              EXPECT_GE(medium.distance_at(none, d, 0, part), 0) << falloff << " " << y << " " << slope;
          }
  // Level rays in density 1, endless up, and the density of the deep.
  EXPECT_EQ(Medium(falling(20.7), glm::dvec3(0)).length(glm::dvec3(0), {1, 0, 0}, {0, 7}), 7);
  EXPECT_NEAR(Medium(falling(20.7), glm::dvec3(0)).length(glm::dvec3(0), {0, 1, 0}, {0, everything}), 1 / 20.7, 1e-16);
  EXPECT_EQ(Medium(falling(1), glm::dvec3(0)).length(glm::dvec3(0), {0, -1, 0}, {0, everything}), everything);
  // 1e-8 per metre over a metre: all digits.
  Fog thin = falling(0);
  thin.extinction_per_m = glm::dvec3(1e-8);
  EXPECT_NEAR(Medium(thin, glm::dvec3(0)).held(1).x, 1e-8 - 5e-17, 1e-23);
}

TEST(Medium, BoundsCutRays) {
  Fog fog = falling(0);
  fog.lowest = {-1, -2, -3}, fog.highest = {1, 2, 3};
  const Medium medium(fog, {0, 0, 10});
  const auto inside = [&](glm::dvec3 o, glm::dvec3 d) {
    return medium.inside(o, d, {0, std::numeric_limits<double>::infinity()});
  };
  EXPECT_EQ(inside({0, 0, 0}, {0, 0, -1}).begin_m, 7);
  EXPECT_EQ(inside({0, 0, 0}, {0, 0, -1}).end_m, 13);
  EXPECT_EQ(inside({0, 0, -10}, {0, 0, -1}).begin_m, 0);
  EXPECT_EQ(inside({0, 0, -10}, {0, 0, -1}).end_m, 3);
  EXPECT_TRUE(inside({0, 0, 0}, {0, 0, 1}).empty());
  EXPECT_TRUE(inside({1.5, 0, 0}, {0, 0, -1}).empty());
  EXPECT_TRUE(inside({1.5, 0, -10}, {0, 1, 0}).empty());
  // The same world, moved: what is subtracted is exact.
  fog.height_m = 1e6 + 0.5, fog.falloff_per_m = 2, fog.lowest += 1e6, fog.highest += 1e6;
  Fog here = fog;
  here.height_m = 0.5, here.lowest -= 1e6, here.highest -= 1e6;
  const glm::dvec3 d = glm::normalize(glm::dvec3(0.1, 0.2, -1));
  const Medium far(fog, glm::dvec3(1e6) + glm::dvec3(0, 0, 10)), near(here, {0, 0, 10});
  EXPECT_EQ(far.transmittance({0, 0, 0}, d, 20), near.transmittance({0, 0, 0}, d, 20));
}

TEST(Medium, ThePhaseFunctionIntegratesToOneWithMeanCosineG) {
  for (const double g : {-0.98, -0.5, -1e-9, 0.0, 1e-12, 0.3, 0.9, 0.98}) {
    // Over the cosine as 1 - exp(-s): the spike is spread out.
    double sum = 0, mean = 0;
    const auto add = [&](double cosine, double weight) {
      const double p = henyey_greenstein(cosine, g) * 2 * pi * weight;
      sum += p, mean += p * cosine;
    };
    constexpr int steps = 400'000;
    for (int i = 0; i < steps; ++i) {
      const double t = (i + 0.5) / steps, away = 2 * t * t * t;  // 1 - |cosine| from the spike's side
      add(g < 0 ? -1 + away : 1 - away, 6 * t * t / steps);
    }
    EXPECT_NEAR(sum, 1, 1e-6) << g;
    EXPECT_NEAR(mean, g, 1e-6) << g;

    Rng rng(5);
    double chosen = 0, second = 0;
    constexpr int count = 200'000;
    const glm::dvec3 onward = glm::normalize(glm::dvec3(0.3, -0.8, 0.5));
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 l = sample_henyey_greenstein(onward, g, {(i + 0.5) / count, rng.uniform(0, 1)});
      EXPECT_NEAR(glm::length(l), 1, 1e-12);
      const double cosine = glm::dot(l, onward);
      chosen += cosine, second += 1.5 * cosine * cosine - 0.5;
    }
    // The Legendre moments of Henyey and Greenstein are the powers of g.
    EXPECT_NEAR(chosen / count, g, 1e-4) << g;
    EXPECT_NEAR(second / count, g * g, 1e-4) << g;
  }
}

TEST(Medium, EquiAngularPlacesHaveTheirDensity) {
  for (const auto& [light, span] : {std::pair(glm::dvec3(0.5, 0, -3), Span{1, 6}),
                                    {glm::dvec3(0.5, 0, 3), Span{1, 6}},
                                    {glm::dvec3(0, 0, -3), Span{0, 1e9}},
                                    {glm::dvec3(2, 0, -3), Span{0, std::numeric_limits<double>::infinity()}},
                                    {glm::dvec3(1e-3, 0, -1e6), Span{1e6 + 1, 1e6 + 2}}}) {
    EquiAngular angles(glm::dvec3(0), {0, 0, -1}, light);
    angles.limit(span);
    double last = span.begin_m;
    constexpr int steps = 2000;
    for (int i = 1; i < steps; ++i) {
      const double at = angles.distance_at(double(i) / steps);
      ASSERT_GE(at, last);
      ASSERT_LE(at, span.end_m);
      // Each of the steps holds the same fraction of the density.
      EXPECT_NEAR(simpson(last, at, 40, [&](double t) { return angles.density(t); }) * steps, 1, 1e-3)
          << light.z << " " << i;
      last = at;
    }
  }
}

}  // namespace candela::reference::test::reference_medium
