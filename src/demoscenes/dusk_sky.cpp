#include "demoscenes/dusk_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"

namespace candela {
namespace {

using std::numbers::pi;

glm::dvec3 mix(glm::dvec3 a, glm::dvec3 b, double t) { return a + (b - a) * t; }

}  // namespace

glm::dvec3 dusk_sky_radiance(glm::dvec3 d, uint64_t seed) {
  // The sun has set at -Z, a little to the left.
  const glm::dvec3 sunset = glm::normalize(glm::dvec3(-0.045, 0, -1));
  const double height = std::max(d.y, 0.0), across = std::max(std::hypot(d.x, d.z), 1e-6);
  const double toward = 0.5 + 0.5 * (d.x * sunset.x + d.z * sunset.z) / across;  // 1 at the sunset's azimuth
  const double near_sunset = std::pow(toward, 3.5);
  const glm::dvec3 zenith(0.014, 0.042, 0.15), middle(0.04, 0.13, 0.34), low(0.13, 0.19, 0.3);
  glm::dvec3 sky = mix(zenith, middle, std::exp(-2.6 * height));
  sky = mix(sky, low, std::exp(-9 * height) * 0.8);
  // The glow: orange at the horizon, rose above it.
  sky += near_sunset *
         (glm::dvec3(2.2, 0.85, 0.22) * std::exp(-14 * height) + glm::dvec3(0.5, 0.2, 0.17) * std::exp(-6.5 * height));
  sky += std::pow(toward, 60.0) * glm::dvec3(5, 2.4, 0.7) * std::exp(-16 * height);
  // Bands of cloud on a plane overhead, which draw together towards the horizon.
  const double scale = 0.1 / (height + 0.12);
  const double x = 0.5 + d.x * scale * 0.6, z = 0.5 + d.z * scale * 1.9;
  const double cover = tiling_octaves(x - std::floor(x), z - std::floor(z), 5, 5, seed + 40);
  const double cloud = smooth_step(0.47, 0.72, cover) * smooth_step(0.015, 0.1, height);
  const glm::dvec3 dark(0.03, 0.045, 0.09), lit = glm::dvec3(1.5, 0.5, 0.3) * near_sunset * std::exp(-3.5 * height);
  sky = mix(sky, dark + lit * (0.35 + 0.65 * smooth_step(0.47, 0.6, cover) * (1 - smooth_step(0.6, 0.8, cover))),
            0.75 * cloud);
  if (d.y < 0) sky = mix(sky, glm::dvec3(0.02, 0.02, 0.025), smooth_step(0, 0.08, -d.y));
  return sky;
}

std::vector<std::byte> make_dusk_sky(uint64_t seed) {
  return radiance_hdr(256, [seed](glm::dvec3 d) { return dusk_sky_radiance(d, seed); });
}

std::vector<std::byte> radiance_hdr(int height, const std::function<glm::dvec3(glm::dvec3)>& radiance) {
  const int width = 2 * height;
  const std::string head =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  std::vector<std::byte> out;
  for (char c : head) out.push_back(std::byte(c));
  std::vector<std::array<uint8_t, 4>> line(size_t(width), {0, 0, 0, 0});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double polar = pi * (y + 0.5) / height, azimuth = 2 * pi * ((x + 0.5) / width - 0.5);
      const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
      const glm::dvec3 c = radiance(d);
      int exponent = 0;
      std::frexp(std::max({c.x, c.y, c.z, 1e-6}), &exponent);
      const double unit = std::ldexp(256.0, -exponent);
      for (int i = 0; i < 3; ++i) line[size_t(x)][size_t(i)] = uint8_t(std::clamp(std::floor(c[i] * unit), 0.0, 255.0));
      line[size_t(x)][3] = uint8_t(exponent + 128);
    }
    for (int b : {2, 2, width >> 8, width & 255}) out.push_back(std::byte(b));
    for (size_t channel = 0; channel < 4; ++channel)
      for (size_t x = 0; x < line.size();) {
        size_t run = 1;
        while (run < 127 && x + run < line.size() && line[x + run][channel] == line[x][channel]) ++run;
        if (run > 2) {
          out.push_back(std::byte(128 + run));
          out.push_back(std::byte(line[x][channel]));
          x += run;
          continue;
        }
        size_t literal = 1;
        while (literal < 128 && x + literal < line.size()) {
          const size_t at = x + literal;
          if (at + 2 < line.size() && line[at][channel] == line[at + 1][channel] &&
              line[at][channel] == line[at + 2][channel])
            break;
          ++literal;
        }
        out.push_back(std::byte(literal));
        for (size_t i = 0; i < literal; ++i) out.push_back(std::byte(line[x + i][channel]));
        x += literal;
      }
  }
  return out;
}

}  // namespace candela
