#include "render/mip_chain.h"

#include <cmath>
#include <cstring>

#include "base/check.h"

namespace candela {
namespace {

double srgb_decode(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double srgb_encode(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

const std::array<float, 256>& decode_table() {
  static const auto table = [] {
    std::array<float, 256> t;
    for (int i = 0; i < 256; ++i) t[size_t(i)] = float(srgb_decode(i / 255.0));
    return t;
  }();
  return table;
}
// 65,536 entries keep the dark end, where the curve is steepest, within half a code value.
const std::vector<uint8_t>& encode_table() {
  static const auto table = [] {
    std::vector<uint8_t> t(65536);
    for (int i = 0; i < 65536; ++i) t[size_t(i)] = uint8_t(std::lround(255 * srgb_encode(i / 65535.0)));
    return t;
  }();
  return table;
}

// One level in linear floats, RGBA.
struct Level {
  int width, height;
  std::vector<float> texels;
};

Level to_linear(const DecodedImage& image, bool srgb) {
  Level level{image.width, image.height, std::vector<float>(size_t(image.width) * size_t(image.height) * 4)};
  const size_t values = level.texels.size();
  switch (image.format) {
    case DecodedImage::Format::rgba8: {
      const auto* in = reinterpret_cast<const uint8_t*>(image.pixels.data());
      const auto& table = decode_table();
      for (size_t i = 0; i < values; ++i)
        level.texels[i] = srgb && i % 4 != 3 ? table[in[i]] : float(in[i]) * (1.0f / 255);
      break;
    }
    case DecodedImage::Format::rgba16: {
      const auto* in = reinterpret_cast<const uint16_t*>(image.pixels.data());
      for (size_t i = 0; i < values; ++i)
        level.texels[i] = srgb && i % 4 != 3 ? float(srgb_decode(in[i] / 65535.0)) : float(in[i]) * (1.0f / 65535);
      break;
    }
    case DecodedImage::Format::rgba32f:
      std::memcpy(level.texels.data(), image.pixels.data(), values * 4);
      break;
  }
  return level;
}

std::vector<std::byte> to_format(const Level& level, VkFormat format) {
  const size_t values = level.texels.size();
  const auto quantise = [](float v, float scale) { return uint32_t(std::clamp(v, 0.0f, 1.0f) * scale + 0.5f); };
  if (format == VK_FORMAT_R32G32B32A32_SFLOAT) {
    std::vector<std::byte> bytes(values * 4);
    std::memcpy(bytes.data(), level.texels.data(), bytes.size());
    return bytes;
  }
  if (format == VK_FORMAT_R16G16B16A16_UNORM) {
    std::vector<std::byte> bytes(values * 2);
    auto* out = reinterpret_cast<uint16_t*>(bytes.data());
    for (size_t i = 0; i < values; ++i) out[i] = uint16_t(quantise(level.texels[i], 65535));
    return bytes;
  }
  std::vector<std::byte> bytes(values);
  auto* out = reinterpret_cast<uint8_t*>(bytes.data());
  const bool srgb = format == VK_FORMAT_R8G8B8A8_SRGB;
  const auto& table = encode_table();
  for (size_t i = 0; i < values; ++i)
    out[i] = srgb && i % 4 != 3 ? table[quantise(level.texels[i], 65535)] : uint8_t(quantise(level.texels[i], 255));
  return bytes;
}

// Which source texels a destination texel covers on one axis: two for even sizes, three with fractional ends for odd
// ones.
struct Taps {
  int first, count;
  float weight[3];
};
Taps taps(int source_size, int size, int at) {
  const double from = double(at) * source_size / size, to = double(at + 1) * source_size / size;
  Taps t{int(from), 0, {}};
  for (int s = t.first; s < source_size && double(s) < to - 1e-9 && t.count < 3; ++s)
    t.weight[t.count++] = float((std::min(to, s + 1.0) - std::max(from, double(s))) / (to - from));
  return t;
}

Level half_size(const Level& in) {
  Level out{std::max(1, in.width / 2), std::max(1, in.height / 2), {}};
  out.texels.resize(size_t(out.width) * size_t(out.height) * 4);
  std::vector<Taps> columns;
  for (int x = 0; x < out.width; ++x) columns.push_back(taps(in.width, out.width, x));
  for (int y = 0; y < out.height; ++y) {
    const Taps rows = taps(in.height, out.height, y);
    for (int x = 0; x < out.width; ++x) {
      const Taps& c = columns[size_t(x)];
      float sum[4] = {};
      for (int j = 0; j < rows.count; ++j)
        for (int i = 0; i < c.count; ++i) {
          const float w = rows.weight[j] * c.weight[i];
          const float* texel = in.texels.data() + (size_t(rows.first + j) * size_t(in.width) + size_t(c.first + i)) * 4;
          for (int k = 0; k < 4; ++k) sum[k] += w * texel[k];
        }
      std::memcpy(out.texels.data() + (size_t(y) * size_t(out.width) + size_t(x)) * 4, sum, 16);
    }
  }
  return out;
}

}  // namespace

gpu::TextureData make_mip_chain(const DecodedImage& image, bool srgb, bool mipmaps) {
  gpu::TextureData data;
  data.width = uint32_t(image.width);
  data.height = uint32_t(image.height);
  data.format = image.format == DecodedImage::Format::rgba32f  ? VK_FORMAT_R32G32B32A32_SFLOAT
                : image.format == DecodedImage::Format::rgba16 ? VK_FORMAT_R16G16B16A16_UNORM
                : srgb                                         ? VK_FORMAT_R8G8B8A8_SRGB
                                                               : VK_FORMAT_R8G8B8A8_UNORM;
  const bool as_stored = !(srgb && image.format == DecodedImage::Format::rgba16);
  const bool single = !mipmaps || (image.width == 1 && image.height == 1);
  if (as_stored) data.levels.push_back(image.pixels);
  if (as_stored && single) return data;
  Level level = to_linear(image, srgb);
  if (!as_stored) data.levels.push_back(to_format(level, data.format));
  while (!single && (level.width > 1 || level.height > 1)) {
    level = half_size(level);
    data.levels.push_back(to_format(level, data.format));
  }
  return data;
}

}  // namespace candela
