#include "sky/sky_sun.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <numbers>

#include "scene/environment.h"

namespace candela::frame_sky_sun {
namespace {

using std::numbers::pi;
using Radiance = std::function<glm::dvec3(glm::dvec3)>;

// Means over the texels, so that a disc narrower than one is there too.
DecodedImage sky_of(int width, int height, const Radiance& f, int parts = 3) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  std::vector<glm::vec4> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      glm::dvec3 sum(0);
      for (int i = 0; i < parts * parts; ++i)
        sum += f(equirect_direction((x + (i % parts + 0.5) / parts) / width, (y + (i / parts + 0.5) / parts) / height));
      texels.emplace_back(glm::vec3(sum / double(parts * parts)), 1);
    }
  const auto bytes = std::as_bytes(std::span(texels));
  image.pixels.assign(bytes.begin(), bytes.end());
  return image;
}
glm::dvec3 blue_sky(glm::dvec3 d) {
  return d.y > 0 ? glm::dvec3(0.3, 0.5, 1) * (1.2 - d.y) : glm::dvec3(0.12, 0.1, 0.08);
}
Radiance with_disc(glm::dvec3 middle, double radius_deg, double radiance, const Radiance& rest = blue_sky) {
  return [=](glm::dvec3 d) {
    return glm::dot(d, middle) > std::cos(glm::radians(radius_deg)) ? radiance * glm::dvec3(1, 0.9, 0.8) : rest(d);
  };
}
glm::dvec3 irradiance(const DecodedImage& image, glm::dvec3 n) {
  glm::dvec3 sum(0);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      glm::vec3 t;
      std::memcpy(&t, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 12);
      const double solid_angle =
          2 * pi / image.width * (std::cos(pi * y / image.height) - std::cos(pi * (y + 1) / image.height));
      const glm::dvec3 d = equirect_direction((x + 0.5) / image.width, (y + 0.5) / image.height);
      sum += std::max(glm::dot(d, n), 0.0) * solid_angle * glm::dvec3(t);
    }
  return sum;
}
glm::dvec3 at(double elevation_deg, double azimuth_deg) {
  const double e = glm::radians(elevation_deg), a = glm::radians(azimuth_deg);
  return {std::cos(e) * std::cos(a), std::sin(e), std::cos(e) * std::sin(a)};
}

struct Place {
  const char* what;
  glm::dvec3 middle;
};
const Place places[] = {
    {"anywhere", at(35, 40)},     {"on the seam", at(20, 180)},        {"beside the seam", at(50, 179.6)},
    {"in the zenith", at(90, 0)}, {"beside the zenith", at(89.5, 70)}, {"in the nadir", at(-90, 0)}};

TEST(SkySun, IsFoundWhereverItStands) {
  for (const Place& p : places) {
    const auto sun = find_sun(sky_of(512, 256, with_disc(p.middle, 1, 20000)));
    ASSERT_TRUE(sun) << p.what;
    EXPECT_TRUE(sun->is_sun()) << p.what;
    EXPECT_LT(glm::degrees(std::acos(std::min(glm::dot(sun->direction, p.middle), 1.0))), 0.1) << p.what;
    // The disc, and the tent of a texel about its edge.
    EXPECT_NEAR(glm::degrees(sun->radius_rad), 1.15, 0.2) << p.what;
  }
}

// On surfaces of any direction that see all of it: the rest and the light give what the image gave.
TEST(SkySun, TakesNoLightAway) {
  for (const Place& p : places) {
    const DecodedImage whole = sky_of(512, 256, with_disc(p.middle, 1, 20000));
    DecodedImage rest = whole;
    auto sun = find_sun(rest);
    ASSERT_TRUE(sun) << p.what;
    const auto before = take_sun(rest, *sun);
    EXPECT_FALSE(before.empty()) << p.what;
    for (const glm::dvec3 n : {sun->direction, glm::normalize(sun->direction + glm::dvec3(0.3, 0.4, 0.5)),
                               glm::normalize(sun->direction + glm::dvec3(-0.7, 0.2, 0.1))}) {
      const glm::dvec3 was = irradiance(whole, n),
                       is = irradiance(rest, n) + std::max(glm::dot(n, sun->direction), 0.0) * sun->illuminance;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(is[c], was[c], 5e-4 * was[c]) << p.what << " " << c;
    }
    // What is left is as bright there as around it; and the texels as they were make the image again.
    const auto again = find_sun(rest);
    EXPECT_FALSE(again && again->is_sun()) << p.what;
    for (const SkyTexelBefore& t : before) std::memcpy(rest.pixels.data() + size_t(t.place) * 16, &t.radiance, 12);
    EXPECT_EQ(rest.pixels, whole.pixels) << p.what;
  }
}

// Its upper half alone shines, and stands that much higher.
TEST(SkySun, CutByTheHorizon) {
  const glm::dvec3 middle = at(0, 60);
  const DecodedImage image = sky_of(1024, 512, [&](glm::dvec3 d) {
    return d.y > 0 && glm::dot(d, middle) > std::cos(glm::radians(0.5)) ? glm::dvec3(1e5, 7e4, 4e4) : blue_sky(d);
  });
  auto sun = find_sun(image);
  ASSERT_TRUE(sun);
  EXPECT_TRUE(sun->is_sun());
  // The middle of a half disc is 4 / (3 pi) of the radius from its edge.
  EXPECT_NEAR(glm::degrees(std::asin(sun->direction.y)), 0.5 * 4 / (3 * pi), 0.05);
  DecodedImage rest = image;
  take_sun(rest, *sun);
  for (const glm::dvec3 n : {glm::dvec3(0, 1, 0), middle, at(60, 60)}) {
    const glm::dvec3 was = irradiance(image, n),
                     is = irradiance(rest, n) + std::max(glm::dot(n, sun->direction), 0.0) * sun->illuminance;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(is[c], was[c], 1e-3 * was[c]);
  }
}

TEST(SkySun, IsNoneOfOtherSkies) {
  const auto is_sun = [](const DecodedImage& image) {
    const auto sun = find_sun(image);
    return sun && sun->is_sun();
  };
  EXPECT_FALSE(find_sun(sky_of(
      64, 32, [](glm::dvec3) { return glm::dvec3(0); }, 1)));
  EXPECT_FALSE(is_sun(sky_of(
      64, 32, [](glm::dvec3) { return glm::dvec3(3); }, 1)));
  EXPECT_FALSE(is_sun(sky_of(256, 128, blue_sky)));
  // An overcast sky is three times as bright above as at the horizon (CIE), and brighter about a hidden sun.
  EXPECT_FALSE(is_sun(sky_of(256, 128, [](glm::dvec3 d) {
    const double sky = (1 + 2 * std::max(d.y, 0.0)) / 3;
    return glm::dvec3(sky + 10 * std::exp(20 * (glm::dot(d, at(40, 10)) - 1)));
  })));
  // Soft boxes and a window: wide, however bright.
  const auto box = [](double half_deg, double radiance) {
    return [=](glm::dvec3 d) {
      const double up = glm::degrees(std::asin(d.y)), round = glm::degrees(std::atan2(d.z, d.x));
      return std::abs(up - 30) < half_deg && std::abs(round - 20) < 0.6 * half_deg ? glm::dvec3(radiance)
                                                                                   : glm::dvec3(0.1);
    };
  };
  for (const double half_deg : {3.0, 6.0, 20.0}) EXPECT_FALSE(is_sun(sky_of(512, 256, box(half_deg, 1e4)))) << half_deg;
  // A spot that is hardly brighter than its sky, and one of little light.
  EXPECT_FALSE(is_sun(sky_of(512, 256, with_disc(at(40, 0), 1, 5))));
  EXPECT_FALSE(is_sun(sky_of(1024, 512, with_disc(at(40, 0), 0.3, 1000))));
  EXPECT_TRUE(is_sun(sky_of(1024, 512, with_disc(at(40, 0), 0.3, 10000))));
}

// One texel is as wide as texels are: a sun where it is narrow enough, and never without a number.
TEST(SkySun, OfOneTexel) {
  for (const int height : {4, 8, 32, 128})
    for (const int row : {0, height / 3, height - 1}) {
      DecodedImage image = sky_of(
          2 * height, height, [](glm::dvec3) { return glm::dvec3(0); }, 1);
      const glm::vec3 bright(1e30f);
      std::memcpy(image.pixels.data() + (size_t(row) * size_t(image.width) + 1) * 16, &bright, 12);
      auto sun = find_sun(image);
      ASSERT_TRUE(sun) << height;
      EXPECT_TRUE(std::isfinite(glm::length(sun->direction)) && std::isfinite(sun->radius_rad)) << height;
      EXPECT_NEAR(sun->share, 1, 1e-6) << height;
      EXPECT_EQ(sun->is_sun(), height >= 32) << height << " " << row << " " << sun->radius_rad;
      take_sun(image, *sun);
      for (const std::byte b : image.pixels)
        ASSERT_TRUE(b == std::byte(0) || b == std::byte(0x80) || b == std::byte(0x3f));
    }
}

}  // namespace
}  // namespace candela::frame_sky_sun
