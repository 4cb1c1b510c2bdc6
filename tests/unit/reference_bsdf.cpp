// Surfaces that let light through, against closed forms and quadrature.
#include "reference/bsdf.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "reference/interior.h"
#include "reference/sampling.h"

namespace candela::reference::reference_bsdf {
namespace {

using std::numbers::pi;

glm::dvec3 direction(double degrees, double longitude = 0) {  // from +Z
  const double t = degrees * pi / 180;
  return {std::sin(t) * std::cos(longitude), std::sin(t) * std::sin(longitude), std::cos(t)};
}

// The surface points to its glass.
struct Pane {
  Glass glass;
  Surface s;
  Pane(bool body, double eta, double roughness, glm::dvec3 color = glm::dvec3(1)) {
    glass.body = body, glass.ior = eta;
    s.normal = s.geometric = {0, 0, 1};
    s.base_color = color;
    s.roughness = roughness;
    s.transmission = 1;
    s.eta = eta;
    s.glass = &glass;
  }
  Pane(const Pane&) = delete;
};

struct Sampled {
  double energy = 0, made = 0, through = 0;  // radiance of a uniform furnace; share of samples that gave a direction
};
// In a furnace of basic radiance 1 (radiance over the index's square) what comes from behind is eta squared as bright.
Sampled sampled(const Surface& s, glm::dvec3 v, int count = 1 << 15) {
  Sampled out;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 0, 0, uint64_t(i));
    const glm::dvec2 u = stream.next2();
    const auto next = sample_bsdf(s, v, stream.next(), u);
    if (!next) continue;
    EXPECT_NEAR(glm::length(next->l), 1, 1e-9);
    EXPECT_EQ(next->through, next->l.z < 0);
    const double energy = next->weight.x * (next->through && s.glass->body ? s.eta * s.eta : 1) / count;
    out.energy += energy, out.made += 1.0 / count;
    if (next->through) out.through += energy;
  }
  return out;
}

// The same by quadrature over the sphere of directions, and the integral of the density.
Sampled integrated(const Surface& s, glm::dvec3 v) {
  Sampled out;
  const int rows = 600, columns = 240;
  for (int i = 0; i < rows; ++i) {
    // Finer towards the poles, where lobes about the normal are narrow.
    const double t = (i + 0.5) / rows, polar = pi * t, area = 2 * pi / columns * pi / rows * std::sin(polar);
    for (int j = 0; j < columns; ++j) {
      const glm::dvec3 l = direction(polar * 180 / pi, 2 * pi * (j + 0.5) / columns);
      const double energy = evaluate_bsdf(s, l, v).x * area * (l.z < 0 && s.glass->body ? s.eta * s.eta : 1);
      out.energy += energy, out.made += bsdf_pdf(s, l, v) * area;
      if (l.z < 0) out.through += energy;
    }
  }
  return out;
}

}  // namespace

TEST(Bsdf, FresnelHasItsKnownValues) {
  for (const double n : {1.0, 1.33, 1.5, 2.4, 1 / 1.5, 1e9})
    EXPECT_NEAR(fresnel(1, n), std::pow((n - 1) / (n + 1), 2), 1e-15);
  // At Brewster's angle, tan = n, only the perpendicular half is reflected: ((1 - n2) / (1 + n2)) squared, halved.
  const double n = 1.5, brewster = std::cos(std::atan(n)), s = (1 - n * n) / (1 + n * n);
  EXPECT_NEAR(fresnel(brewster, n), s * s / 2, 1e-15);
  // The same from either side along the same way.
  for (const double degrees : {0.0, 20.0, 50.0, 80.0}) {
    const double c = std::cos(degrees * pi / 180), behind = std::sqrt(1 - (1 - c * c) / (n * n));
    EXPECT_NEAR(fresnel(c, n), fresnel(behind, 1 / n), 1e-14);
  }
  // From glass, beyond asin(1/n) = 41.8 degrees, nothing leaves.
  EXPECT_LT(fresnel(std::cos(41.7 * pi / 180), 1 / n), 1);
  EXPECT_EQ(fresnel(std::cos(41.9 * pi / 180), 1 / n), 1);
  EXPECT_NEAR(fresnel(0, n), 1, 1e-15);
}

TEST(Bsdf, ASmoothBodyBendsByTheLawOfSnell) {
  for (const double eta : {1.5, 1.33, 1 / 1.5}) {
    Pane p(true, eta, 0);
    for (const double degrees : {0.0, 10.0, 40.0, 89.0}) {
      const glm::dvec3 v = direction(degrees, 0.6);
      const double r = fresnel(v.z, eta);
      const auto mirrored = sample_bsdf(p.s, v, r * 0.999, {0.3, 0.6});
      ASSERT_TRUE(mirrored);
      EXPECT_FALSE(mirrored->through);
      EXPECT_NEAR(glm::length(mirrored->l - glm::dvec3(-v.x, -v.y, v.z)), 0, 1e-14);
      EXPECT_NEAR(mirrored->weight.x, 1, 1e-12);
      EXPECT_EQ(mirrored->pdf, 0);
      if (r == 1) continue;
      const auto bent = sample_bsdf(p.s, v, r + (1 - r) / 2, {0.3, 0.6});
      ASSERT_TRUE(bent);
      EXPECT_TRUE(bent->through && !bent->straight);
      EXPECT_NEAR(bent->l.x, -v.x / eta, 1e-14);
      EXPECT_NEAR(bent->l.y, -v.y / eta, 1e-14);
      EXPECT_LT(bent->l.z, 0);
      // All energy goes on; radiance is that of the other medium.
      EXPECT_NEAR(bent->weight.x, 1 / (eta * eta), 1e-12);
    }
  }
}

TEST(Bsdf, TotalReflectionLosesNothing) {
  Pane p(true, 1 / 1.5, 0, {0.2, 0.2, 0.2});
  p.s.dielectric_f90 = 0.1;  // the specular extension dims reflections, but nothing can leave here
  for (const double lobe : {0.0, 0.5, 0.999}) {
    const auto next = sample_bsdf(p.s, direction(60), lobe, {0.5, 0.5});
    ASSERT_TRUE(next);
    EXPECT_FALSE(next->through);
    EXPECT_NEAR(next->weight.x, 1, 1e-12);
  }
}

TEST(Bsdf, IndexOneIsNotThere) {
  for (const double roughness : {0.0, 0.5}) {
    Pane p(true, 1, roughness);
    for (const double lobe : {0.0, 0.4, 0.999}) {
      const auto next = sample_bsdf(p.s, direction(70), lobe, {0.1, 0.9});
      ASSERT_TRUE(next);
      EXPECT_TRUE(next->straight && next->through);
      EXPECT_EQ(next->weight, glm::dvec3(1));
      EXPECT_EQ(next->l, -direction(70));
    }
    EXPECT_EQ(evaluate_bsdf(p.s, direction(20), direction(70), true), glm::dvec3(0));
    EXPECT_EQ(straight_share(p.s, direction(70)), glm::dvec3(1));
  }
}

// KHR_materials_ior: 0 stands for reflecting all.
TEST(Bsdf, IndexZeroLetsNothingThrough) {
  Pane p(true, 1, 0);
  p.glass.ior = 0;
  p.s.dielectric_f0 = glm::dvec3(1);
  EXPECT_EQ(index_of_refraction(p.glass, -1), 1);
  for (const double lobe : {0.0, 0.999}) {
    const auto next = sample_bsdf(p.s, direction(30), lobe, {0.1, 0.9});
    ASSERT_TRUE(next);
    EXPECT_FALSE(next->through);
    EXPECT_NEAR(next->weight.x, 1, 1e-12);
  }
  EXPECT_EQ(straight_share(p.s, direction(30)), glm::dvec3(0));
}

TEST(Bsdf, AThinSheetTintsAndDoesNotBend) {
  const glm::dvec3 color(0.9, 0.5, 0.1);
  Pane p(false, 1.5, 0, color);
  p.s.transmission = 0.75;
  const glm::dvec3 v = direction(50, 1);
  const double r = fresnel(v.z, 1.5);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(straight_share(p.s, v)[c], 0.75 * (1 - r) * color[c], 1e-15);
  // Chosen as often as it weighs: the mean of what is sampled is the fraction.
  glm::dvec3 straight(0), mirrored(0), diffuse(0);
  const int count = 1 << 14;
  for (int i = 0; i < count; ++i) {
    const auto next = sample_bsdf(p.s, v, (i + 0.5) / count, {0.2, 0.7});
    if (!next) continue;
    (next->straight ? straight : next->pdf > 0 ? diffuse : mirrored) += next->weight / double(count);
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(straight[c], 0.75 * (1 - r) * color[c], 2e-4);
    EXPECT_NEAR(mirrored[c], r, 2e-4);
    EXPECT_GT(diffuse[c], 0.25 * 0.5 * color[c]);
  }
}

// Light that goes from a medium to another meets the same resistance both ways: f over the square of the viewer's index
// is symmetric.
TEST(Bsdf, RoughRefractionIsReciprocal) {
  for (const double roughness : {0.2, 0.5, 1.0}) {
    Pane there(true, 1.5, roughness), back(true, 1 / 1.5, roughness);
    back.s.normal = back.s.geometric = {0, 0, -1};
    for (const double outside : {5.0, 40.0, 75.0})
      for (const double inside : {175.0, 160.0, 145.0}) {
        const glm::dvec3 v = direction(outside, 0.3), l = direction(inside, 2.6);
        const double f = evaluate_bsdf(there.s, l, v).x / -l.z, g = evaluate_bsdf(back.s, v, l).x / v.z;
        EXPECT_NEAR(f * 1.5 * 1.5, g, 1e-12 * g) << roughness << " " << outside << " " << inside;
        EXPECT_GE(g, 0);
      }
  }
  Pane sheet(false, 1.5, 0.5), behind(false, 1.5, 0.5);
  behind.s.normal = behind.s.geometric = {0, 0, -1};
  const glm::dvec3 v = direction(20), l = direction(140, 2);
  EXPECT_GT(evaluate_bsdf(sheet.s, l, v).x, 0);
  EXPECT_NEAR(evaluate_bsdf(sheet.s, l, v).x / -l.z, evaluate_bsdf(behind.s, v, l).x / v.z, 1e-12);
}

// The estimate from sampled directions is the integral; the density's integral is the fraction of samples that gave a
// direction.
TEST(Bsdf, RoughSamplingAgreesWithTheIntegral) {
  for (const bool body : {true, false})
    for (const double eta : {1.5, 1 / 1.5})
      for (const double roughness : {0.4, 0.8})
        for (const double degrees : {0.0, 30.0, 65.0}) {
          if (!body && eta < 1) continue;
          Pane p(body, eta, roughness);
          p.s.transmission = degrees == 30 ? 0.6 : 1;
          p.s.metallic = degrees == 65 ? 0.25 : 0;
          const glm::dvec3 v = direction(degrees, 0.4);
          const Sampled estimate = sampled(p.s, v), exact = integrated(p.s, v);
          const std::string where = fmt::format("{} {} {} {}", body, eta, roughness, degrees);
          EXPECT_NEAR(estimate.energy, exact.energy, 6e-3) << where;
          EXPECT_NEAR(estimate.through, exact.through, 6e-3) << where;
          EXPECT_NEAR(estimate.made, exact.made, 6e-3) << where;
          EXPECT_LE(exact.made, 1 + 2e-3) << where;
        }
}

// Only what bounces between facets is lost: little where they are nearly even.
TEST(Bsdf, TheRoughFurnaceKeepsAlmostAll) {
  for (const bool body : {true, false})
    for (const double degrees : {0.0, 40.0})
      for (const auto& [roughness, least] : {std::pair(0.1, 0.999), {0.3, 0.985}}) {
        Pane p(body, 1.5, roughness);
        const double energy = sampled(p.s, direction(degrees)).energy;
        EXPECT_GT(energy, least) << body << degrees << roughness;
        EXPECT_LE(energy, 1 + 1e-3) << body << degrees << roughness;
      }
  // A sheet sends to its two sides what a metal sends to one: 1 - ln 2 at alpha 1 and normal incidence
  // (reference_brdf.cpp).
  Pane sheet(false, 1.5, 1);
  EXPECT_NEAR(sampled(sheet.s, direction(0)).energy, 1 - std::log(2.0), 1e-3);
}

TEST(Bsdf, ExtremesAreFinite) {
  for (const bool body : {true, false})
    for (const double eta : {1e-9, 1 / 3e38, 1.0, 1 + 2e-7, 1e9, 3e38})
      for (const double roughness : {0.0, 0.045, 1.0})
        for (const double degrees : {0.0, 89.9999, 90.0}) {
          Pane p(body, eta, roughness, glm::dvec3(1e6));
          p.s.specular_tint = glm::dvec3(1e30);
          const glm::dvec3 v = direction(degrees, 0.1);
          for (int i = 0; i < 64; ++i) {
            const auto next = sample_bsdf(p.s, v, i / 64.0, {std::fmod(i * 0.618, 1), std::fmod(i * 0.755, 1)});
            if (!next) continue;
            EXPECT_TRUE(std::isfinite(next->weight.x) && std::isfinite(next->l.x) && std::isfinite(next->pdf))
                << body << " " << eta << " " << roughness << " " << degrees;
            EXPECT_TRUE(std::isfinite(evaluate_bsdf(p.s, next->l, v, true).x));
          }
        }
}

TEST(Interior, LightHasItsColourAfterItsDistance) {
  Glass red, clear;
  red.body = clear.body = true;
  red.attenuation_color = {0.8, 0.25, 0}, red.attenuation_distance_m = 2;
  clear.attenuation_distance_m = std::numeric_limits<double>::infinity();
  Interior inside;
  EXPECT_EQ(inside.transmittance(7), glm::dvec3(1));
  inside.enter(red);
  EXPECT_EQ(inside.transmittance(2), red.attenuation_color);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(inside.transmittance(3)[c], std::pow(red.attenuation_color[c], 1.5), 1e-15);
  EXPECT_EQ(inside.transmittance(0), glm::dvec3(1));
  EXPECT_EQ(inside.transmittance(std::numeric_limits<double>::infinity()), glm::dvec3(0));
  red.attenuation_color.x = 1;
  EXPECT_EQ(inside.transmittance(std::numeric_limits<double>::infinity()).x, 1);
  red.attenuation_distance_m = 1e-38;
  EXPECT_EQ(inside.transmittance(1), glm::dvec3(1, 0, 0));
  // The body entered last counts, in whatever order they are left.
  clear.ior = 1.2;
  inside.enter(clear);
  EXPECT_EQ(inside.ior(), 1.2);
  EXPECT_EQ(inside.transmittance(5), glm::dvec3(1));
  inside.leave(red);
  EXPECT_EQ(inside.ior(), 1.2);
  inside.leave(red);
  inside.leave(clear);
  EXPECT_TRUE(inside.empty());
  for (int i = 0; i < 50; ++i) inside.enter(red);
  for (int i = 0; i < 50; ++i) inside.leave(red);
  EXPECT_TRUE(inside.empty());
}

// KHR_materials_dispersion: the index at the ends of the spectrum is the nominal one and half of (n - 1) / V20 times 20
// / Abbe number apart.
TEST(Interior, DispersionSpreadsTheIndex) {
  Glass flint;
  flint.ior = 1.6, flint.dispersion = 20 / 30.0;
  const double half = (1.6 - 1) * 0.025 * 20 / 30;
  EXPECT_DOUBLE_EQ(index_of_refraction(flint, 0), 1.6 - half);
  EXPECT_DOUBLE_EQ(index_of_refraction(flint, 1), 1.6);
  EXPECT_DOUBLE_EQ(index_of_refraction(flint, 2), 1.6 + half);
  EXPECT_DOUBLE_EQ(index_of_refraction(flint, -1), 1.6);
  flint.dispersion = 1e9;
  EXPECT_EQ(index_of_refraction(flint, 0), 1);
}

}  // namespace candela::reference::reference_bsdf
