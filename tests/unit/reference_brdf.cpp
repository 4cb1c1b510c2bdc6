#include "reference/brdf.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/sampling.h"

namespace candela::reference::reference_brdf {
namespace {

using std::numbers::pi;

glm::dvec3 direction(double degrees, double longitude = 0) {  // from +Z
  const double t = degrees * pi / 180;
  return {std::sin(t) * std::cos(longitude), std::sin(t) * std::sin(longitude), std::cos(t)};
}
Surface surface(double roughness, double metallic, glm::dvec3 color = glm::dvec3(1)) {
  Surface s;
  s.normal = s.geometric = {0, 0, 1};
  s.base_color = color;
  s.roughness = roughness, s.metallic = metallic;
  return s;
}
Surface diffuse(glm::dvec3 color) {
  Surface s = surface(1, 0, color);
  s.dielectric_f0 = glm::dvec3(0), s.dielectric_f90 = 0;
  return s;
}

// Reflected share of a uniform sky, by quadrature over the hemisphere, fine about the mirror direction.
double albedo(const Surface& s, glm::dvec3 v) {
  double sum = 0;
  const double alpha = std::max(s.roughness * s.roughness, 1e-3);
  const int rows = int(std::clamp(120 / alpha, 200.0, 1200.0));
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      const double z = (i + 0.5) / rows, longitude = 2 * pi * (j + 0.5) / rows, r = std::sqrt(1 - z * z);
      sum += evaluate_brdf(s, {r * std::cos(longitude), r * std::sin(longitude), z}, v).x;
    }
  return sum * 2 * pi / (double(rows) * rows);
}

struct Sampled {
  double albedo = 0, above = 0;  // mean of f / pdf, share of directions above the surface
};
Sampled sampled(const Surface& s, glm::dvec3 v) {
  Sampled out;
  constexpr int count = 1 << 14;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 0, 0, uint64_t(i));
    const glm::dvec2 u = stream.next2();
    const glm::dvec3 l = sample_brdf(s, v, stream.next(), u);
    EXPECT_NEAR(glm::length(l), 1, 1e-9);
    const double pdf = brdf_pdf(s, l, v);
    if (!(pdf > 0)) continue;
    out.albedo += evaluate_brdf(s, l, v).x / pdf / count;
    out.above += 1.0 / count;
  }
  return out;
}

}  // namespace

TEST(Brdf, IsReciprocal) {
  for (const double metallic : {0.0, 0.4, 1.0})
    for (const double roughness : {0.1, 0.5, 1.0}) {
      const Surface s = surface(roughness, metallic, {0.8, 0.4, 0.2});
      const glm::dvec3 l = direction(35, 1), v = direction(70, 4);
      const glm::dvec3 there = evaluate_brdf(s, l, v) / l.z, back = evaluate_brdf(s, v, l) / v.z;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 1e-12 * there[c]);
    }
}

TEST(Brdf, NothingComesFromBelow) {
  EXPECT_EQ(evaluate_brdf(surface(0.5, 0.5), direction(91), direction(10)), glm::dvec3(0));
  EXPECT_EQ(brdf_pdf(surface(0.5, 0.5), direction(91), direction(10)), 0);
  // Against the view, and from where nobody can look: finite all the same.
  const Surface s = surface(0, 1);
  for (const glm::dvec3 v : {direction(0), direction(90), direction(120), -direction(20, 2)})
    for (const glm::dvec3 l : {direction(0), direction(89.999), direction(20, 2)}) {
      EXPECT_TRUE(std::isfinite(evaluate_brdf(s, l, v).x));
      EXPECT_TRUE(std::isfinite(brdf_pdf(s, l, v)));
    }
}

// A surface that reflects all light reflects all of a uniform sky: exactly, where there is no specular layer.
TEST(Brdf, TheWhiteDiffuseFurnaceIsOne) {
  for (const double degrees : {0.0, 45.0, 80.0}) {
    EXPECT_NEAR(albedo(diffuse(glm::dvec3(1)), direction(degrees)), 1, 1e-12);
    EXPECT_NEAR(sampled(diffuse(glm::dvec3(1)), direction(degrees)).albedo, 1, 1e-12);
  }
}

// Single scattering loses what bounces between facets. A white metal at normal incidence keeps the fraction that is
// seen of facets lit from all around; for alpha = 1 the height-correlated term has the closed form below, for alpha
// near 0 nothing is lost.
TEST(Brdf, TheMetalFurnaceLosesSingleScatteringsShare) {
  for (const double roughness : {0.2, 0.4, 0.7, 1.0})
    for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
      const double a = albedo(surface(roughness, 1), direction(degrees));
      EXPECT_LE(a, 1 + 1e-3) << roughness << " " << degrees;
      EXPECT_GT(a, 0.3);
    }
  EXPECT_NEAR(albedo(surface(0.2, 1), direction(0)), 1, 1e-2);
  // alpha = 1, v = n: D = 1/pi, V = 1/(2 (1 + n.l)); the integral of 2 x/(2 (1 + x)) dx with n.l = x is 1 - ln 2.
  EXPECT_NEAR(albedo(surface(1, 1), direction(0)), 1 - std::log(2.0), 1e-5);
}

// Metals never gain. A white dielectric does in glTF's model, whose diffuse part is dimmed by the Fresnel term of the
// half vector alone: up to 15 % at grazing angles. That is the model's, and the renderer's, and so the reference's.
TEST(Brdf, OnlyWhiteDielectricsGainEnergy) {
  for (const double roughness : {0.3, 0.6, 1.0})
    for (const double degrees : {0.0, 50.0, 75.0}) {
      EXPECT_LE(albedo(surface(roughness, 1), direction(degrees)), 1.001);
      EXPECT_LE(albedo(surface(roughness, 0, glm::dvec3(0.8)), direction(degrees)), 1.001);
      EXPECT_LE(albedo(surface(roughness, 0), direction(degrees)), 1.15);
    }
}

// The estimate from sampled directions is the integral, and the density is that of the directions: those below the
// surface, which have none, make up the rest of its integral.
TEST(Brdf, SamplingAgreesWithTheIntegral) {
  for (const double metallic : {0.0, 1.0})
    for (const double roughness : {0.3, 0.6, 1.0})
      for (const double degrees : {0.0, 50.0, 80.0}) {
        const Surface s = surface(roughness, metallic, {0.7, 0.7, 0.7});
        const glm::dvec3 v = direction(degrees, 0.7);
        const Sampled estimate = sampled(s, v);
        EXPECT_NEAR(estimate.albedo, albedo(s, v), 6e-3) << roughness << " " << metallic << " " << degrees;
        double density = 0;
        const int rows = 400;
        for (int i = 0; i < rows; ++i)
          for (int j = 0; j < rows; ++j) {
            const double z = (i + 0.5) / rows, longitude = 2 * pi * (j + 0.5) / rows, r = std::sqrt(1 - z * z);
            density +=
                brdf_pdf(s, {r * std::cos(longitude), r * std::sin(longitude), z}, v) * 2 * pi / (double(rows) * rows);
          }
        EXPECT_NEAR(density, estimate.above, 6e-3) << roughness << " " << metallic << " " << degrees;
      }
}

}  // namespace candela::reference::reference_brdf
