#include "reference/texture.h"

#include <cmath>
#include <cstring>

namespace candela::reference {
namespace {

// IEC 61966-2-1.
double srgb_decoded(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

// Values of 8-bit codes: as they are, and decoded.
struct ByteCurves {
  double linear[256], srgb[256];
  ByteCurves() {
    for (int i = 0; i < 256; ++i) linear[i] = i / 255.0, srgb[i] = srgb_decoded(i / 255.0);
  }
};
const ByteCurves curves;

int wrapped(double texel, int size, Wrap wrap) {
  const double period = wrap == Wrap::mirror ? 2.0 * size : size;
  if (wrap == Wrap::clamp) return int(std::clamp(texel, 0.0, double(size - 1)));
  int i = int(texel - period * std::floor(texel / period));
  if (i >= int(period)) i = 0;  // the quotient was rounded up
  return i < size ? i : 2 * size - 1 - i;
}

}  // namespace

glm::dvec2 transformed_uv(const TextureSlot& slot, glm::dvec2 uv) {
  const glm::dvec2 scaled = glm::dvec2(slot.scale) * uv;
  const double c = std::cos(double(slot.rotation_rad)), s = std::sin(double(slot.rotation_rad));
  return {c * scaled.x + s * scaled.y + double(slot.offset.x), -s * scaled.x + c * scaled.y + double(slot.offset.y)};
}

glm::dvec4 Texture::texel(int x, int y) const {
  const size_t at = (size_t(y) * size_t(image_.width) + size_t(x)) * 4;
  glm::dvec4 c;
  switch (image_.format) {
    case DecodedImage::Format::rgba8: {
      const std::byte* p = image_.pixels.data() + at;
      const double* curve = srgb_ ? curves.srgb : curves.linear;
      for (int i = 0; i < 3; ++i) c[i] = curve[std::to_integer<size_t>(p[i])];
      c.w = curves.linear[std::to_integer<size_t>(p[3])];
      return c;
    }
    case DecodedImage::Format::rgba16: {
      uint16_t codes[4];
      std::memcpy(codes, image_.pixels.data() + at * 2, 8);
      for (int i = 0; i < 4; ++i) c[i] = srgb_ && i < 3 ? srgb_decoded(codes[i] / 65535.0) : codes[i] / 65535.0;
      return c;
    }
    default: {
      float values[4];
      std::memcpy(values, image_.pixels.data() + at * 4, 16);
      return glm::dvec4(values[0], values[1], values[2], values[3]);
    }
  }
}

glm::dvec4 Texture::sample(glm::dvec2 uv, const Sampler& sampler) const {
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::dvec2(0);
  const glm::dvec2 at = uv * glm::dvec2(image_.width, image_.height);
  if (sampler.mag == Filter::nearest)
    return texel(wrapped(std::floor(at.x), image_.width, sampler.wrap_u),
                 wrapped(std::floor(at.y), image_.height, sampler.wrap_v));
  const glm::dvec2 low = glm::floor(at - 0.5), f = at - 0.5 - low;
  const int x0 = wrapped(low.x, image_.width, sampler.wrap_u), x1 = wrapped(low.x + 1, image_.width, sampler.wrap_u);
  const int y0 = wrapped(low.y, image_.height, sampler.wrap_v), y1 = wrapped(low.y + 1, image_.height, sampler.wrap_v);
  return glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), f.x), glm::mix(texel(x0, y1), texel(x1, y1), f.x), f.y);
}

glm::dvec4 Texture::mean(glm::dvec2 uv, const glm::dvec2 sides[2], const Sampler& sampler, bool premultiplied) const {
  constexpr double points_a_texel = 4, most_points = 512;
  const glm::dvec2 size(image_.width, image_.height);
  int points[2];
  for (int i = 0; i < 2; ++i) {
    const double wanted = std::ceil(points_a_texel * glm::length(sides[i] * size));
    points[i] = std::isfinite(wanted) ? int(std::clamp(wanted, 1.0, most_points)) : 1;
  }
  const int count = points[0] * points[1];
  if (count == 1) return sample(uv, sampler);
  glm::dvec4 sum(0);
  for (int j = 0; j < points[1]; ++j)
    for (int i = 0; i < points[0]; ++i) {
      const glm::dvec2 at((i + 0.5) / points[0] - 0.5, (j + 0.5) / points[1] - 0.5);
      const glm::dvec4 c = sample(uv + at.x * sides[0] + at.y * sides[1], sampler);
      sum += premultiplied ? glm::dvec4(glm::dvec3(c) * c.w, c.w) : c;
    }
  if (!premultiplied) return sum / double(count);
  return sum.w > 0 ? glm::dvec4(glm::dvec3(sum) / sum.w, sum.w / count) : glm::dvec4(0);
}

}  // namespace candela::reference
