#include "reference/albedo.h"

#include <gtest/gtest.h>
#include <numbers>

#include "reference/integrator.h"
#include "split_sum_integral.h"

namespace candela::reference {
namespace {

using std::numbers::pi;

AmbientSh uniform_sky() {
  AmbientSh sh{};
  sh[0] = glm::vec3(float(1 / 0.28209479177387814));
  return sh;
}

// What f n.l is over the hemisphere of l, colour by colour: the BRDF as it stands, on a grid of angles.
glm::dvec3 hemisphere_integral(const Surface& s, glm::dvec3 v) {
  constexpr int rows = 360, columns = 480;
  glm::dvec3 sum(0);
  for (int i = 0; i < rows; ++i) {
    const double polar = pi / 2 * (i + 0.5) / rows, z = std::cos(polar), r = std::sin(polar), weight = pi / 2 * r;
    for (int j = 0; j < columns; ++j) {
      const double longitude = pi * (j + 0.5) / columns;  // the other half is its mirror image
      sum += weight * evaluate_brdf(s, {r * std::cos(longitude), r * std::sin(longitude), z}, v);
    }
  }
  return sum * (2 * pi / (double(rows) * columns));
}

}  // namespace

// Under a uniform sky the ambient term is the integral of the BRDF: no fit, scale or bias may stray from it, for any
// roughness, metal and angle.
TEST(Albedo, TheAmbientTermIsTheIntegralOfTheBrdf) {
  for (const double roughness : {0.3, 0.5, 0.8, 1.0})
    for (const double metallic : {0.0, 0.4, 1.0})
      for (const double degrees : {0.0, 40.0, 70.0, 86.0}) {
        Surface s;
        s.normal = s.geometric = {0, 0, 1};
        s.base_color = {0.9, 0.4, 0};
        s.roughness = roughness, s.metallic = metallic;
        s.dielectric_f0 = {0.04, 0.3, 0.02}, s.dielectric_f90 = 0.7;
        const glm::dvec3 v(std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180));
        const HarmonicAmbient lobes = harmonic_ambient(uniform_sky(), s, v);
        const glm::dvec3 ambient = lobes.diffuse + lobes.specular, exact = hemisphere_integral(s, v);
        for (int c = 0; c < 3; ++c) {
          EXPECT_GE(ambient[c], 0) << roughness << " " << metallic << " " << degrees;
          EXPECT_NEAR(ambient[c], exact[c], 1.5e-3)
              << roughness << " " << metallic << " " << degrees << " channel " << c;
        }
      }
}

// With what bounces on between facets a white metal keeps all light, seen from anywhere, and a coloured one is darker
// than its colour by no more than further bounces take: each multiplies by it once more.
TEST(Albedo, AMetalKeepsItsLight) {
  for (const double roughness : {0.3, 0.5, 0.8, 1.0})
    for (const double degrees : {0.0, 40.0, 70.0, 86.0}) {
      Surface s;
      s.normal = s.geometric = {0, 0, 1};
      s.base_color = {1, 0.5, 0};
      s.roughness = roughness, s.metallic = 1;
      const glm::dvec3 v(std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180));
      const glm::dvec3 once = hemisphere_integral(s, v);
      s.specular_gain = specular_gain(s.base_color, roughness, v.z);
      const glm::dvec3 all = hemisphere_integral(s, v);
      EXPECT_NEAR(all.x, 1, 6e-3) << roughness << " " << degrees;
      EXPECT_GE(all.y, once.y);
      EXPECT_LE(all.y, once.y + 0.5 * (1 - once.x) + 4e-3) << roughness << " " << degrees;
      EXPECT_EQ(all.z, once.z);
    }
}

// The table against facets integrated in another way, smooth surfaces and grazing angles with them.
TEST(Albedo, TheTableIsTheIntegralOverFacets) {
  const test::GaussRule rule(32);
  for (const double roughness : {0.0, 0.06, 0.11, 0.2, 0.33, 0.57, 0.81, 1.0})
    for (const double n_v : {3e-4, 0.004, 0.02, 0.07, 0.2, 0.45, 0.8, 1.0}) {
      const DirectionalAlbedo a = directional_albedo(roughness, n_v);
      const test::SplitSum exact = test::split_sum_integral(std::max(roughness, least_roughness), n_v, rule);
      EXPECT_NEAR(a.scale, exact.scale, 2.5e-3) << roughness << " " << n_v;
      EXPECT_NEAR(a.bias, exact.bias, 1e-3) << roughness << " " << n_v;
      EXPECT_NEAR(a.grazing, test::grazing_integral(n_v, rule), 1e-4) << n_v;
      EXPECT_GT(a.scale, 0);
      EXPECT_GE(a.bias, 0);
      EXPECT_LE(a.scale + a.bias, 1 + 1e-4) << roughness << " " << n_v;
      EXPECT_NEAR(specular_gain(glm::dvec3(1), roughness, n_v).x * (exact.scale + exact.bias), 1,
                  n_v < 0.02 ? 0.008 : 0.006)
          << roughness << " " << n_v;
    }
}

}  // namespace candela::reference
