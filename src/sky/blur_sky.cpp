#include "sky/blur_sky.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "sky/sky_pyramid.h"

namespace candela {

DecodedImage blurred_sky(const DecodedImage& image, double deviation_rad) {
  constexpr double pi = std::numbers::pi, reach = 3.2, texels_a_deviation = 2.5;
  const std::vector<SkyLevel> levels = sky_pyramid(sky_level(image));
  size_t at = 0;
  while (levels[at].width > 64 && levels[at].width / 2 >= 2 * pi * texels_a_deviation / deviation_rad) ++at;
  const SkyLevel& sky = levels[at];
  const double away = std::min(reach * deviation_rad, pi);
  // By chords, not by cosines: those of angles below 3e-4 are all 1 as floats.
  const float kappa = float(1 / (deviation_rad * deviation_rad)), longest = float(2 * std::sin(away / 2));
  std::vector<glm::vec3> directions;
  for (int y = 0; y < sky.height; ++y)
    for (int x = 0; x < sky.width; ++x) directions.emplace_back(sky.direction(x, y));
  DecodedImage out{sky.width, sky.height, DecodedImage::Format::rgba32f, 3, {}};
  out.pixels.resize(size_t(sky.width) * size_t(sky.height) * 16);
  tbb::parallel_for(0, sky.height, [&](int y) {
    const double polar = pi * (y + 0.5) / sky.height;
    const int rows = int(away / pi * sky.height) + 1;
    for (int x = 0; x < sky.width; ++x) {
      const glm::vec3 d = directions[size_t(y) * size_t(sky.width) + size_t(x)];
      SkyTexel sum{};
      float weights = 0;
      for (int row = std::max(y - rows, 0); row <= std::min(y + rows, sky.height - 1); ++row) {
        // Where the cap about d ends in longitude; all round where it holds the pole.
        const double other = pi * (row + 0.5) / sky.height;
        const double c = (std::cos(away) - std::cos(polar) * std::cos(other)) / (std::sin(polar) * std::sin(other));
        if (c > 1 && row != y) continue;  // of its own row too, by rounding, where the cap is narrow
        const int half = c < -1 ? sky.width / 2 : int(std::acos(std::min(c, 1.0)) / (2 * pi) * sky.width) + 1;
        const int first = std::max(x - half, x - sky.width / 2), last = std::min(x + half, first + sky.width - 1);
        const float solid_angle = float(sky.solid_angle(row));
        for (int column = first; column <= last; ++column) {
          const size_t i = size_t(row) * size_t(sky.width) + size_t((column + sky.width) % sky.width);
          const glm::vec3 chord = directions[i] - d;
          const float squared = glm::dot(chord, chord);  // 2 (1 - cosine)
          if (squared > longest * longest) continue;
          const float weight = squared > 0 ? solid_angle * std::exp(-0.5f * kappa * squared) : solid_angle;
          sum += weight * sky.texels[i], weights += weight;
        }
      }
      sum = sum / weights;
      sum[3] = 1;
      std::memcpy(out.pixels.data() + (size_t(y) * size_t(sky.width) + size_t(x)) * 16, &sum, 16);
    }
  });
  return out;
}

}  // namespace candela
