#include "sky/sky_pyramid.h"

#include <tbb/parallel_for.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "scene/environment.h"

namespace candela {
namespace {

using std::numbers::pi;
constexpr uint32_t least_width = 64, most_width = 2048;

// row(y): the texels of a row of `in`, which may have none itself.
template <class Row>
SkyLevel half_of(const SkyLevel& in, Row row) {
  SkyLevel out{in.width / 2, in.height / 2, {}};
  out.texels.resize(size_t(out.width) * size_t(out.height));
  tbb::parallel_for(0, out.height, [&](int y) {
    const double above = in.solid_angle(2 * y), below = in.solid_angle(2 * y + 1);
    const float up = float(0.5 * above / (above + below)), down = 0.5f - up;
    SkyTexel* texel = out.texels.data() + size_t(y) * size_t(out.width);
    const auto first = row(2 * y), second = row(2 * y + 1);
    const SkyTexel *top = &first[0], *bottom = &second[0];
    for (int x = 0; x < out.width; ++x, top += 2, bottom += 2)
      *texel++ = up * (top[0] + top[1]) + down * (bottom[0] + bottom[1]);
  });
  return out;
}
SkyLevel half_of(const SkyLevel& in) {
  return half_of(in, [&](int y) { return &in.at(0, y); });
}

}  // namespace

double SkyLevel::solid_angle(int row) const {
  return 2 * pi / width * (std::cos(pi * row / height) - std::cos(pi * (row + 1) / height));
}
glm::dvec3 SkyLevel::direction(int x, int y) const { return equirect_direction((x + 0.5) / width, (y + 0.5) / height); }

SkyLevel sky_level(const DecodedImage& image) {
  const auto texel = [&](int x, int y) {
    x = (x % image.width + image.width) % image.width;
    y = std::clamp(y, 0, image.height - 1);
    SkyTexel t = sky_texel(image, size_t(y) * size_t(image.width) + size_t(x));
    t[3] = 0;
    return t;
  };
  const uint32_t widest = std::bit_ceil(uint32_t(std::max(image.width, 2 * image.height)));
  SkyLevel out;
  out.width = int(std::max(widest, least_width));
  out.height = out.width / 2;
  const bool same = image.width == out.width && image.height == out.height;
  const auto make_row = [&](int y, SkyTexel* into) {
    for (int x = 0; x < out.width; ++x) {
      if (same) {
        into[x] = texel(x, y);
        continue;
      }
      const double u = (x + 0.5) / out.width * image.width - 0.5, v = (y + 0.5) / out.height * image.height - 0.5;
      const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
      const float fx = float(u - x0), fy = float(v - y0);
      into[x] = (1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0)) +
                fy * ((1 - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1));
    }
  };
  if (uint32_t(out.width) > most_width) {  // its own texels are never there all at once
    out = half_of(out, [&](int y) {
      std::vector<SkyTexel> row(size_t(out.width));
      make_row(y, row.data());
      return row;
    });
    while (uint32_t(out.width) > most_width) out = half_of(out);
    return out;
  }
  out.texels.resize(size_t(out.width) * size_t(out.height));
  tbb::parallel_for(0, out.height, [&](int y) { make_row(y, out.texels.data() + size_t(y) * size_t(out.width)); });
  return out;
}

std::vector<SkyLevel> sky_pyramid(SkyLevel sky) {
  std::vector<SkyLevel> levels;
  levels.push_back(std::move(sky));
  while (levels.back().width > 4) levels.push_back(half_of(levels.back()));
  return levels;
}

}  // namespace candela
