// Skies without an image.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "scene/atmosphere.h"
#include "scene/environment.h"
#include "scene/gradient_sky.h"

namespace candela::test {
namespace {

using std::numbers::pi;

glm::vec3 texel(const DecodedImage& image, int x, int y) {
  glm::vec3 t;
  std::memcpy(&t, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 12);
  return t;
}
glm::dvec3 sun_at(double elevation_deg) {
  const double e = elevation_deg * pi / 180;
  return {std::cos(e), std::sin(e), 0};
}
double luminance(glm::dvec3 c) { return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)); }

// The same air by random walks, with no table: every photon's path backwards from the eye, the sun asked at each place.
struct Walker {
  static constexpr double ground = 6'360'000, top = 6'460'000;
  std::mt19937_64 random{1};
  double next() { return std::uniform_real_distribution<double>(0, 1)(random); }
  static glm::dvec3 molecules(double h) { return std::exp(-h / 8000) * glm::dvec3(5.802e-6, 13.558e-6, 33.1e-6); }
  static double aerosols(double h) { return std::exp(-h / 1200) * 3.996e-6; }
  static glm::dvec3 extinction(double h) {
    const double ozone = std::max(0.0, 1 - std::abs(h - 25000) / 15000);
    return molecules(h) + std::exp(-h / 1200) * 4.440e-6 + ozone * glm::dvec3(0.650e-6, 1.881e-6, 0.085e-6);
  }
  static bool hits_ground(glm::dvec3 p, glm::dvec3 d) {
    const double b = glm::dot(p, d), c = glm::dot(p, p) - ground * ground;
    return b < 0 && b * b > c;
  }
  static double end_of(glm::dvec3 p, glm::dvec3 d, bool at_ground) {
    const double b = glm::dot(p, d), r = at_ground ? ground : top, c = glm::dot(p, p) - r * r;
    return at_ground ? -b - std::sqrt(std::max(b * b - c, 0.0)) : -b + std::sqrt(std::max(b * b - c, 0.0));
  }
  static glm::dvec3 through(glm::dvec3 p, glm::dvec3 d, double length) {
    constexpr int steps = 40;
    glm::dvec3 depth(0);
    for (int i = 0; i < steps; ++i)
      depth += extinction(std::max(glm::length(p + (i + 0.5) / steps * length * d) - ground, 0.0)) * (length / steps);
    return glm::exp(-depth);
  }
  static double aerosol_phase(double c) {
    constexpr double g = 0.8;
    return 3 / (8 * pi) * (1 - g * g) * (1 + c * c) / ((2 + g * g) * std::pow(1 + g * g - 2 * g * c, 1.5));
  }
  glm::dvec3 walk(glm::dvec3 p, glm::dvec3 d, glm::dvec3 sun, double albedo) {
    glm::dvec3 sum(0), weight(1);
    for (int bounce = 0; bounce < 12; ++bounce) {
      const bool at_ground = hits_ground(p, d);
      const double end = end_of(p, d, at_ground);
      // Places by distance, the nearer the likelier, or the ground.
      const bool to_surface = at_ground && next() < 0.5;
      const double chance = at_ground ? 0.5 : 1, u = next(), t = to_surface ? end : end * u * u;
      const glm::dvec3 at = p + t * d;
      const double r = glm::length(at), sun_sine = glm::dot(at, sun) / r;
      const bool lit = !hits_ground(at + at / r, sun);
      const glm::dvec3 light = lit ? through(at, sun, end_of(at, sun, false)) : glm::dvec3(0);
      weight *= through(p, d, t);
      if (to_surface) {
        weight *= albedo / 0.5;
        sum += weight * light * std::max(sun_sine, 0.0) / pi;
        const glm::dvec3 n = at / r;
        glm::dvec3 out = any_direction();
        d = glm::normalize(n + 0.9999 * out);
        p = at + n;
        continue;
      }
      const double density = 1 / (2 * end * u);  // of t
      const glm::dvec3 m = molecules(std::max(r - ground, 0.0));
      const double a = aerosols(std::max(r - ground, 0.0)), c = glm::dot(d, sun);
      const glm::dvec3 m_part = m * (3 / (16 * pi) * (1 + c * c)), a_part = glm::dvec3(a * aerosol_phase(c));
      weight /= density * chance;
      sum += weight * (m_part + a_part) * light;
      const glm::dvec3 out = any_direction();
      const double co = glm::dot(d, out);
      weight *= (m * (3 / (16 * pi) * (1 + co * co)) + a * aerosol_phase(co)) * (4 * pi);
      d = out, p = at;
    }
    return sum;
  }
  glm::dvec3 any_direction() {
    const double y = 2 * next() - 1, phi = 2 * pi * next(), across = std::sqrt(1 - y * y);
    return {across * std::cos(phi), y, across * std::sin(phi)};
  }
};

}  // namespace

TEST(GradientSky, IsItsFormula) {
  for (const double exponent : {0.5, 1.0, 3.0}) {
    EXPECT_EQ(gradient_share(0, exponent, 1), 1);
    EXPECT_EQ(gradient_share(1, exponent, 0), 1);
    EXPECT_EQ(gradient_share(2, exponent, -1), 1);
    for (double s = -1; s <= 1; s += 0.01)
      EXPECT_NEAR(gradient_share(0, exponent, s) + gradient_share(1, exponent, s) + gradient_share(2, exponent, s), 1,
                  1e-12);
    const DecodedImage image = gradient_image(0, exponent, 4, 512);
    for (int y = 0; y < 512; ++y)
      EXPECT_NEAR(texel(image, 1, y).x, gradient_share(0, exponent, std::cos(pi * (y + 0.5) / 512)), 0.02) << y;
  }
}

// All orders of scattering against random walks through the same air.
TEST(Air, ComesNearRandomWalks) {
  const Atmosphere atmosphere{};
  const Air air(atmosphere);
  Walker walker;
  for (const double elevation : {60.0, 10.0})
    for (const glm::dvec3 d :
         {glm::dvec3(0, 1, 0), glm::normalize(glm::dvec3(-1, 0.4, 0.3)), glm::normalize(glm::dvec3(0.2, 0.25, 1))}) {
      glm::dvec3 sum(0);
      constexpr int walks = 6000;
      for (int i = 0; i < walks; ++i)
        sum +=
            walker.walk({0, Walker::ground + atmosphere.altitude_m, 0}, d, sun_at(elevation), atmosphere.ground_albedo);
      const glm::dvec3 wanted = sum / double(walks), got = air.radiance(d, sun_at(elevation));
      EXPECT_NEAR(luminance(got) / luminance(wanted), 1, 0.12) << elevation << " " << d.y;
      EXPECT_NEAR(got.z / wanted.z, 1, 0.15) << elevation << " " << d.y;
    }
}

TEST(Air, IsBlueByDayRedAtTheHorizonAndBlackByNight) {
  const Air air({});
  const glm::dvec3 day = air.radiance({0, 1, 0}, sun_at(50));
  EXPECT_GT(day.z, 2.5 * day.x);
  EXPECT_GT(luminance(day), 0.005);
  EXPECT_LT(luminance(day), 0.1);
  const glm::dvec3 dusk = air.radiance(glm::normalize(glm::dvec3(1, 0.02, 0)), sun_at(0));
  EXPECT_GT(dusk.x, 3 * dusk.z);
  // The eye of the Earth's shadow: darker by far, and none at all in the depth of night.
  EXPECT_LT(luminance(air.radiance({0, 1, 0}, sun_at(-12))), 1e-3 * luminance(day));
  EXPECT_EQ(luminance(air.radiance({0, 1, 0}, sun_at(-90))), 0);
  double before = 1e9;
  for (const double elevation : {20.0, 5.0, 0.0, -3.0, -6.0, -9.0}) {
    const double now = luminance(air.radiance({0, 1, 0}, sun_at(elevation)));
    EXPECT_LT(now, before) << elevation;
    before = now;
  }
}

TEST(Air, IsFiniteAndNeverNegative) {
  for (const Atmosphere& a : {Atmosphere{}, Atmosphere{.haze = 100, .altitude_m = 0},
                              Atmosphere{.haze = 0, .ozone = 0, .ground_albedo = 1, .altitude_m = 50'000},
                              Atmosphere{.haze = 100, .ozone = 100, .ground_albedo = 0}}) {
    const Air air(a);
    for (const double elevation : {90.0, 0.0, -0.3, -90.0}) {
      const DecodedImage image = air.image(sun_at(elevation), 32, 16);
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
          for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::isfinite(texel(image, x, y)[c])) << elevation;
            EXPECT_GE(texel(image, x, y)[c], 0.0f) << elevation;
          }
    }
    EXPECT_TRUE(std::isfinite(luminance(air.radiance({0, 1, 0}, {0, 1, 0})))) << "into the sun";
    EXPECT_TRUE(std::isfinite(luminance(air.radiance({1, 0, 0}, {1, 0, 0}))));
  }
}

// The half that is copied is what it would be.
TEST(Air, IsTheSameOnBothSidesOfTheSun) {
  const Air air({});
  const glm::dvec3 sun = sun_at(20);
  const DecodedImage image = air.image(sun, 16, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      const glm::dvec3 d = equirect_direction((x + 0.5) / 16, (y + 0.5) / 8), wanted = air.radiance(d, sun);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(texel(image, x, y)[c], wanted[c], 1e-5 * wanted[c] + 1e-9);
    }
}

}  // namespace candela::test
