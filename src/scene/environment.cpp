#include "scene/environment.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "image/sky_texel.h"
#include "math/spherical_harmonics.h"

namespace candela {
namespace {
using std::numbers::pi;

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
  // One direction stands for a cell: texels of small images are cut, or a sky of one texel would shine from its middle
  // alone.
  const int cut_x = (63 + image.width) / image.width, cut_y = (31 + image.height) / image.height;
  const int width = image.width * cut_x, height = image.height * cut_y;
  std::vector<glm::dvec2> columns;  // cosine and sine of the longitude, as equirect_direction() has them
  for (int x = 0; x < width; ++x) {
    const double longitude = ((x + 0.5) / width - 0.5) * 2 * pi;
    columns.emplace_back(std::cos(longitude), std::sin(longitude));
  }
  // Blocks of rows of large images are summed by several threads, always the same blocks.
  const int block_rows = width > 4096 ? 64 : height;
  std::vector<std::array<glm::dvec3, 9>> sums(size_t((height + block_rows - 1) / block_rows));
  const auto add_row = [&](int y, std::array<glm::dvec3, 9>& sum) {
    const double top = std::cos(pi * y / height), bottom = std::cos(pi * (y + 1) / height);
    const double solid_angle = 2 * pi / width * (top - bottom);
    const double polar = (y + 0.5) / height * pi, across = std::sin(polar), up = std::cos(polar);
    for (int x = 0; x < width; ++x) {
      const SkyTexel texel = sky_texel(image, size_t(y / cut_y) * size_t(image.width) + size_t(x / cut_x));
      const glm::dvec2 column = columns[size_t(x)];
      const auto basis = sh_basis(glm::dvec3(across * column.x, up, across * column.y));
      const glm::dvec3 weighted = glm::dvec3(texel[0], texel[1], texel[2]) * solid_angle;
      for (size_t i = 0; i < 9; ++i) sum[i] += weighted * basis[i];
    }
  };
  tbb::parallel_for(size_t(0), sums.size(), [&](size_t block) {
    const int first = int(block) * block_rows, end = std::min(first + block_rows, height);
    for (int y = first; y < end; ++y) add_row(y, sums[block]);
  });
  std::array<glm::dvec3, 9> sum = sums.front();
  for (size_t block = 1; block < sums.size(); ++block)
    for (size_t i = 0; i < 9; ++i) sum[i] += sums[block][i];
  return convolve(sum);
}

AmbientSh turned(const AmbientSh& sh, double angle_rad, double times) {
  if (angle_rad == 0 && times == 1) return sh;
  // The second band as a quadratic form, in which a rotation acts on both sides. Factors as in sh_basis().
  constexpr double a = 1.092548 / 2, b = 0.315392;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const glm::dmat3 rotation(c, 0, -s, 0, 1, 0, s, 0, c);  // columns
  AmbientSh out;
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](size_t i) { return double(sh[i][k]); };
    const glm::dvec3 first = rotation * glm::dvec3(at(3), at(1), at(2));
    const double xy = a * at(4), yz = a * at(5), xz = a * at(7);
    const glm::dmat3 form(a * at(8) - b * at(6), xy, xz, xy, -a * at(8) - b * at(6), yz, xz, yz, 2 * b * at(6));
    const glm::dmat3 q = rotation * form * glm::transpose(rotation);
    const double values[9] = {at(0),
                              first.y,
                              first.z,
                              first.x,
                              q[0][1] / a,
                              q[1][2] / a,
                              q[2][2] / (2 * b),
                              q[0][2] / a,
                              (q[0][0] - q[1][1]) / (2 * a)};
    for (size_t i = 0; i < 9; ++i) out[i][k] = float(times * values[i]);
  }
  return out;
}

AmbientSh neutral_ambient() {
  // Radiance 0.45 + 0.25 y: in the basis, the constant 0.45 / 0.282095 and the y term 0.25 / 0.488603.
  std::array<glm::dvec3, 9> radiance{};
  radiance[0] = glm::dvec3(0.45 / 0.282095);
  radiance[1] = glm::dvec3(0.25 / 0.488603);
  return convolve(radiance);
}

}  // namespace candela
