// Blinn's lobe against quadrature over light directions: energy, reciprocity, sampling, and its ends.
#include "reference/blinn_phong.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "reference/bsdf.h"
#include "reference/sampling.h"
#include "scene/blinn_phong.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr double exponents[] = {0, 0.5, 2, 8, 32, 200, 5000, 1e6};
constexpr double cosines[] = {1, 0.9, 0.6, 0.3, 0.05, 1e-3};

Surface surface_of(double exponent, glm::dvec3 diffuse, glm::dvec3 specular) {
  Surface s;
  s.normal = s.geometric = {0, 0, 1};
  s.base_color = diffuse;
  s.dielectric_f0 = specular, s.dielectric_f90 = 1;
  s.exponent = exponent;
  s.roughness = roughness_of_exponent(exponent);
  return s;
}
glm::dvec3 view(double n_v) { return {std::sqrt(1 - n_v * n_v), 0, n_v}; }

// Of a uniform sky, over light directions; rings about the mirror direction, denser towards it.
double furnace(const Surface& s, glm::dvec3 v, int rows = 800, int columns = 200) {
  const glm::dvec3 axis = glm::reflect(-v, s.normal);
  glm::dvec3 x, y;
  make_frame(axis, x, y);
  double sum = 0;
  for (int i = 0; i < rows; ++i) {
    const double t = (i + 0.5) / rows, polar = pi * std::pow(t, 5),
                 area = 2 * pi / columns * 5 * pi * std::pow(t, 4) / rows * std::sin(polar);
    for (int j = 0; j < columns; ++j) {
      const double turn = 2 * pi * (j + 0.5) / columns;
      const glm::dvec3 l = std::sin(polar) * (std::cos(turn) * x + std::sin(turn) * y) + std::cos(polar) * axis;
      sum += evaluate_bsdf(s, l, v).x * area;
    }
  }
  return sum;
}

}  // namespace

TEST(BlinnPhong, WhiteReflectsAllTowardsItsNormalAndNeverMore) {
  for (const double exponent : exponents) {
    const Surface white = surface_of(exponent, glm::dvec3(0), glm::dvec3(1));
    for (const double n_v : cosines) {
      const double sum = furnace(white, view(n_v));
      EXPECT_LE(sum, 1.001) << exponent << " at " << n_v;
      EXPECT_NEAR(integrate_blinn_phong(exponent, n_v, 300), sum, 0.002) << exponent << " at " << n_v;
      EXPECT_NEAR(blinn_phong_albedo(exponent, n_v), sum, 0.003) << exponent << " at " << n_v;
      if (n_v == 1) EXPECT_NEAR(sum, 1, 1e-3) << exponent;
    }
  }
}

// What the specular lobe reflects at its best the base does not get.
TEST(BlinnPhong, AWholeSurfaceNeverReflectsMoreThanArrives) {
  for (const double exponent : exponents)
    for (const double specular : {0.0, 0.04, 0.5, 1.0})
      for (const double metallic : {0.0, 0.5, 1.0}) {
        Surface s = surface_of(exponent, glm::dvec3(1), glm::dvec3(specular));
        s.metallic = metallic;
        for (const double n_v : cosines) EXPECT_LE(furnace(s, view(n_v), 400, 120), 1.001);
      }
}

TEST(BlinnPhong, IsReciprocal) {
  for (const double exponent : exponents) {
    const Surface s = surface_of(exponent, glm::dvec3(0.5), glm::dvec3(0.5));
    for (const double a : cosines)
      for (const double b : cosines) {
        const glm::dvec3 l(-std::sqrt(1 - a * a) * 0.6, std::sqrt(1 - a * a) * 0.8, a), v = view(b);
        const double there = evaluate_bsdf(s, l, v).x / a, back = evaluate_bsdf(s, v, l).x / b;
        EXPECT_NEAR(there, back, 1e-9 * there) << exponent;
      }
  }
}

TEST(BlinnPhong, SamplesAddUpToTheFurnace) {
  for (const double exponent : exponents) {
    const Surface s = surface_of(exponent, glm::dvec3(0.6), glm::dvec3(0.4));
    for (const double n_v : {1.0, 0.6, 0.2}) {
      const glm::dvec3 v = view(n_v);
      double sum = 0;
      constexpr int count = 1 << 14;
      for (int i = 0; i < count; ++i) {
        SampleStream stream({}, 0, 0, uint64_t(i));
        const glm::dvec2 u = stream.next2();
        const auto next = sample_bsdf(s, v, stream.next(), u);
        if (!next) continue;
        EXPECT_NEAR(glm::length(next->l), 1, 1e-9);
        sum += next->weight.x / count;
      }
      EXPECT_NEAR(sum, furnace(s, v), 0.01) << exponent << " at " << n_v;
    }
  }
}

TEST(BlinnPhong, ItsEndsAreNumbers) {
  for (const double exponent : {0.0, 1e-30, 1e6})
    for (const glm::dvec3 l :
         {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0.6, 0, -0.8), glm::dvec3(0, 0, -1)})
      for (const glm::dvec3 v : {glm::dvec3(0, 0, 1), glm::dvec3(-1, 0, 0), -l}) {
        const Surface s = surface_of(exponent, glm::dvec3(1), glm::dvec3(1));
        const glm::dvec3 f = evaluate_brdf(s, l, v);
        EXPECT_TRUE(std::isfinite(f.x)) << exponent;
        if (l.z <= 0) EXPECT_EQ(f, glm::dvec3(0)) << exponent;
        EXPECT_TRUE(std::isfinite(brdf_pdf(s, l, v)));
      }
  // Exponent 0 is Lambert's surface.
  EXPECT_NEAR(evaluate_brdf(surface_of(0, glm::dvec3(0), glm::dvec3(1)), view(0.5), view(0.2)).x, 0.5 / pi, 1e-12);
}

TEST(BlinnPhong, ExponentsAndRoughnessGoBothWays) {
  for (const double exponent : {0.0, 1.0, 32.0, 1e4, 1e6})
    EXPECT_NEAR(exponent_of_roughness(roughness_of_exponent(exponent)), exponent, 1e-8 * (1 + exponent));
  EXPECT_EQ(exponent_of_roughness(0), most_exponent);
  EXPECT_NEAR(exponent_of_roughness(0.5), 30, 1e-12) << "2 / alpha^2 - 2 with alpha 1/4";
}

}  // namespace candela::reference
