#include "scene/environment.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "math/spherical_harmonics.h"

namespace candela {
namespace {
constexpr double pi = std::numbers::pi;

// A_l / pi: 1, 2/3, 1/4.
AmbientSh convolve(const std::array<glm::dvec3, 9>& radiance) {
  AmbientSh out;
  for (int i = 0; i < 9; ++i)
    out[size_t(i)] = glm::vec3(radiance[size_t(i)] * (i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25));
  return out;
}
}  // namespace

glm::dvec3 equirect_direction(double u, double v) {
  const double longitude = (u - 0.5) * 2 * pi, polar = v * pi;
  return {std::sin(polar) * std::cos(longitude), std::cos(polar), std::sin(polar) * std::sin(longitude)};
}

AmbientSh project_environment(const DecodedImage& image) {
  std::array<glm::dvec3, 9> sum{};
  // One direction stands for a cell: texels of small images are cut, or a sky of one texel would shine from its middle
  // alone.
  const int cut_x = (63 + image.width) / image.width, cut_y = (31 + image.height) / image.height;
  const int width = image.width * cut_x, height = image.height * cut_y;
  for (int y = 0; y < height; ++y) {
    const double top = std::cos(pi * y / height), bottom = std::cos(pi * (y + 1) / height);
    const double solid_angle = 2 * pi / width * (top - bottom);
    for (int x = 0; x < width; ++x) {
      float texel[4];
      std::memcpy(texel, image.pixels.data() + (size_t(y / cut_y) * size_t(image.width) + size_t(x / cut_x)) * 16, 16);
      const auto basis = sh_basis(equirect_direction((x + 0.5) / width, (y + 0.5) / height));
      const glm::dvec3 weighted = glm::dvec3(texel[0], texel[1], texel[2]) * solid_angle;
      for (size_t i = 0; i < 9; ++i) sum[i] += weighted * basis[i];
    }
  }
  return convolve(sum);
}

AmbientSh neutral_ambient() {
  // Radiance 0.45 + 0.25 y: in the basis, the constant 0.45 / 0.282095 and the y term 0.25 / 0.488603.
  std::array<glm::dvec3, 9> radiance{};
  radiance[0] = glm::dvec3(0.45 / 0.282095);
  radiance[1] = glm::dvec3(0.25 / 0.488603);
  return convolve(radiance);
}

}  // namespace candela
