#include <algorithm>
#include <cmath>

#include "demoscenes/city.h"
#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"

// Two skies that the look blends: of the afternoon, and of the evening, which darkens.
namespace candela::city {
namespace {

glm::dvec3 mix(glm::dvec3 a, glm::dvec3 b, double t) { return a + (b - a) * t; }

// The share of the sky that clouds cover, on a plane overhead, whose clouds draw together towards the horizon.
double clouds(glm::dvec3 d, uint64_t seed, glm::dvec2 stretch) {
  const double height = std::max(d.y, 0.0), scale = 0.1 / (height + 0.14);
  const double x = 0.5 + d.x * scale * stretch.x, z = 0.5 + d.z * scale * stretch.y;
  return tiling_octaves(x - std::floor(x), z - std::floor(z), 5, 5, seed);
}

double toward_sunset(glm::dvec3 d) {
  const glm::dvec3 sunset = glm::normalize(glm::dvec3(-0.05, 0, -1));
  return 0.5 + 0.5 * (d.x * sunset.x + d.z * sunset.z) / std::max(std::hypot(d.x, d.z), 1e-6);
}

}  // namespace

glm::dvec3 day_sky_radiance(glm::dvec3 d, uint64_t seed) {
  const double height = std::max(d.y, 0.0), toward = toward_sunset(d);
  const glm::dvec3 zenith(0.022, 0.085, 0.31), middle(0.06, 0.17, 0.43), low(0.13, 0.24, 0.43);
  glm::dvec3 sky = mix(zenith, middle, std::exp(-2.2 * height));
  sky = mix(sky, low, 0.85 * std::exp(-6 * height));
  sky += std::pow(toward, 6) * glm::dvec3(0.16, 0.1, 0.04) * std::exp(-2.5 * height);
  const double cover = clouds(d, seed + 70, {0.9, 1.1});
  const double cloud = smooth_step(0.46, 0.62, cover) * smooth_step(0.02, 0.14, height);
  const glm::dvec3 lit = mix(glm::dvec3(0.56, 0.55, 0.54), glm::dvec3(0.85, 0.74, 0.58), std::pow(toward, 3));
  sky = mix(sky, mix(lit, glm::dvec3(0.34, 0.37, 0.44), smooth_step(0.55, 0.78, cover)), 0.85 * cloud);
  return d.y < 0 ? mix(sky, glm::dvec3(0.2, 0.2, 0.19), smooth_step(0, 0.08, -d.y)) : sky;
}

glm::dvec3 night_sky_radiance(glm::dvec3 d, uint64_t seed) {
  const double height = std::max(d.y, 0.0), toward = toward_sunset(d), near_sunset = std::pow(toward, 3.5);
  const glm::dvec3 zenith(0.012, 0.036, 0.14), middle(0.04, 0.11, 0.31), low(0.12, 0.17, 0.3);
  glm::dvec3 sky = mix(zenith, middle, std::exp(-2.6 * height));
  sky = mix(sky, low, std::exp(-9 * height) * 0.8);
  sky += near_sunset *
         (glm::dvec3(1.9, 0.72, 0.2) * std::exp(-13 * height) + glm::dvec3(0.5, 0.19, 0.18) * std::exp(-5.5 * height));
  sky += std::pow(toward, 40.0) * glm::dvec3(3.2, 1.5, 0.45) * std::exp(-15 * height);
  const double cover = clouds(d, seed + 40, {0.6, 1.9});
  const double cloud = smooth_step(0.48, 0.72, cover) * smooth_step(0.015, 0.1, height);
  const glm::dvec3 dark(0.03, 0.045, 0.09), lit = glm::dvec3(1.5, 0.48, 0.3) * near_sunset * std::exp(-3.2 * height);
  const double rim = smooth_step(0.48, 0.6, cover) * (1 - smooth_step(0.6, 0.8, cover));
  sky = mix(sky, dark + lit * (0.35 + 0.65 * rim), 0.75 * cloud);
  return d.y < 0 ? mix(sky, glm::dvec3(0.02, 0.02, 0.025), smooth_step(0, 0.08, -d.y)) : sky;
}

}  // namespace candela::city
