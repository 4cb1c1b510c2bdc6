#include "session/mip_chain.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>

#include "base/check.h"
#include "base/scratch.h"
#include "image/sky_texel.h"

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
const std::vector<float>& decode_table_16() {
  static const auto table = [] {
    std::vector<float> t(65536);
    for (int i = 0; i < 65536; ++i) t[size_t(i)] = float(srgb_decode(i / 65535.0));
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

// One RGBA texel, a vector register: the compiler leaves the sums of half_size() scalar otherwise.
using Texel = float __attribute__((vector_size(16)));

float vector_length(Texel normal) {
  const Texel n = 2.0f * normal - 1.0f;
  return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}
// Of a mean of normals: its own length from alpha, the mean of theirs. Nothing of them is left: 1.
float slope_deviation(Texel mean) {
  const float length = vector_length(mean), most = mean[3];
  return length > 0 && length < most ? std::sqrt(std::min((most - length) / length, 1.0f))
         : length < most             ? 1.0f
                                     : 0.0f;
}

// One level in linear floats.
struct Level {
  int width, height;
  std::vector<Texel> texels;
};

template <class Code>
void decode_row(const Code* in, int width, const float* curve, float scale, Texel* out) {
  for (int x = 0; x < width; ++x, in += 4) {
    if (curve)
      out[x] = Texel{curve[in[0]], curve[in[1]], curve[in[2]], float(in[3]) * scale};
    else
      out[x] = Texel{float(in[0]), float(in[1]), float(in[2]), float(in[3])} * scale;
  }
}

// The image in linear floats, a row at a time, for as floats the whole of it would take four times the memory. The last
// three rows are kept, which is as many as a texel of the next level covers.
class LinearRows {
 public:
  // with_lengths: alpha is the length of the vector that the texel stands for.
  LinearRows(const DecodedImage& image, bool srgb, bool with_lengths)
      : width(image.width), height(image.height), image_(image), with_lengths_(with_lengths) {
    if (srgb && image.format == DecodedImage::Format::rgba8) curve_ = decode_table().data();
    if (srgb && image.format == DecodedImage::Format::rgba16) curve_ = decode_table_16().data();
    for (Slot& slot : slots_) slot.texels.resize(size_t(width));
  }

  const Texel* row(int y) {
    Slot& slot = slots_[size_t(y) % slots_.size()];
    if (slot.y != y) {
      convert(y, slot.texels.data());
      for (int x = 0; with_lengths_ && x < width; ++x)
        slot.texels[size_t(x)][3] = vector_length(slot.texels[size_t(x)]);
    }
    slot.y = y;
    return slot.texels.data();
  }

  int width, height;

 private:
  struct Slot {
    int y = -1;
    std::vector<Texel> texels;
  };

  void convert(int y, Texel* out) const {
    const size_t first = size_t(y) * size_t(width) * 4;
    switch (image_.format) {
      case DecodedImage::Format::rgba8:
        decode_row(reinterpret_cast<const uint8_t*>(image_.pixels.data()) + first, width, curve_, 1.0f / 255, out);
        break;
      case DecodedImage::Format::rgba16:
        decode_row(reinterpret_cast<const uint16_t*>(image_.pixels.data()) + first, width, curve_, 1.0f / 65535, out);
        break;
      case DecodedImage::Format::rgba32f:
        std::memcpy(out, image_.pixels.data() + first * 4, size_t(width) * sizeof(Texel));
        break;
      case DecodedImage::Format::rgba16f:
        for (int x = 0; x < width; ++x) out[x] = sky_texel(image_, first / 4 + size_t(x));
        break;
    }
  }

  const DecodedImage& image_;
  bool with_lengths_;
  const float* curve_ = nullptr;  // code to linear, when the image is sRGB
  std::array<Slot, 3> slots_;
};

uint32_t quantise(float v, float scale) { return uint32_t(int(std::clamp(v, 0.0f, 1.0f) * scale + 0.5f)); }

// Appends the texels as `format` stores them.
void append(std::vector<std::byte>& bytes, const Texel* texels, size_t count, VkFormat format) {
  const size_t texel_size = format == VK_FORMAT_R32G32B32A32_SFLOAT                                             ? 16
                            : format == VK_FORMAT_R16G16B16A16_UNORM || format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8
                                                                                                                : 4;
  const size_t start = bytes.size();
  bytes.resize(start + count * texel_size);
  std::byte* const out = bytes.data() + start;
  if (format == VK_FORMAT_R32G32B32A32_SFLOAT) {
    std::memcpy(out, texels, count * texel_size);
  } else if (format == VK_FORMAT_R16G16B16A16_SFLOAT) {
    auto* halves = reinterpret_cast<uint16_t*>(out);
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < 4; ++k) halves[i * 4 + k] = float_to_half(texels[i][k]);
  } else if (format == VK_FORMAT_R16G16B16A16_UNORM) {
    auto* codes = reinterpret_cast<uint16_t*>(out);
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < 4; ++k) codes[i * 4 + k] = uint16_t(quantise(texels[i][k], 65535));
  } else {
    auto* codes = reinterpret_cast<uint8_t*>(out);
    const uint8_t* curve = format == VK_FORMAT_R8G8B8A8_SRGB ? encode_table().data() : nullptr;
    for (size_t i = 0; i < count; ++i) {
      for (size_t k = 0; k < 3; ++k)
        codes[i * 4 + k] = curve ? curve[quantise(texels[i][k], 65535)] : uint8_t(quantise(texels[i][k], 255));
      codes[i * 4 + 3] = uint8_t(quantise(texels[i][3], 255));
    }
  }
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

// Rows: LinearRows or StoredRows. out: half as many texels each way, rounded down, at least one.
template <class Rows>
void half_size(Rows& in, Texel* texel, int first, int end) {
  const int width = std::max(1, in.width / 2), height = std::max(1, in.height / 2);
  const bool even = in.width == 2 * width && in.height == 2 * height;
  Scratch scratch;
  ScratchVector<Taps> columns(&scratch);
  for (int x = 0; !even && x < width; ++x) columns.push_back(taps(in.width, width, x));
  for (int y = first; y < end; ++y) {
    if (even) {  // the general case below with all weights 1/4, to the last bit
      const Texel *above = in.row(2 * y), *below = in.row(2 * y + 1);
      for (int x = 0; x < width; ++x, above += 2, below += 2)
        *texel++ = Texel{} + 0.25f * above[0] + 0.25f * above[1] + 0.25f * below[0] + 0.25f * below[1];
      continue;
    }
    const Taps rows = taps(in.height, height, y);
    std::array<const Texel*, 3> row{};
    for (int j = 0; j < rows.count; ++j) row[size_t(j)] = in.row(rows.first + j);
    for (const Taps& column : columns) {
      Texel sum{};
      for (int j = 0; j < rows.count; ++j)
        for (int i = 0; i < column.count; ++i)
          sum += rows.weight[j] * column.weight[i] * row[size_t(j)][column.first + i];
      *texel++ = sum;
    }
  }
}
// A level of floats as it is stored.
struct StoredRows {
  int width, height;
  const Texel* texels;
  const Texel* row(int y) const { return texels + size_t(y) * size_t(width); }
};

// Of large images by several threads, each with rows of its own.
template <class Rows>
Level half_size(const Rows& in) {
  Level out{std::max(1, in.width / 2), std::max(1, in.height / 2), {}};
  out.texels.resize(size_t(out.width) * size_t(out.height));
  tbb::parallel_for(tbb::blocked_range<int>(0, out.height, 256), [&](const auto& range) {
    Rows own = in;
    half_size(own, out.texels.data() + size_t(range.begin()) * size_t(out.width), range.begin(), range.end());
  });
  return out;
}

}  // namespace

gpu::TextureData make_mip_chain(DecodedImage image, bool srgb, bool mipmaps, bool normals) {
  gpu::TextureData data;
  data.width = uint32_t(image.width);
  data.height = uint32_t(image.height);
  data.format = image.format == DecodedImage::Format::rgba32f   ? VK_FORMAT_R32G32B32A32_SFLOAT
                : image.format == DecodedImage::Format::rgba16f ? VK_FORMAT_R16G16B16A16_SFLOAT
                : image.format == DecodedImage::Format::rgba16  ? VK_FORMAT_R16G16B16A16_UNORM
                : srgb                                          ? VK_FORMAT_R8G8B8A8_SRGB
                                                                : VK_FORMAT_R8G8B8A8_UNORM;
  const bool as_stored = !normals && !(srgb && image.format == DecodedImage::Format::rgba16);
  const bool single = !mipmaps || (image.width == 1 && image.height == 1);
  // Level 0 as it is comes last: the others are made of it.
  const auto finished = [&] {
    if (as_stored) data.levels.front() = std::move(image.pixels);
    return std::move(data);
  };
  if (as_stored) data.levels.emplace_back();
  if (as_stored && single) return finished();
  LinearRows rows(image, srgb, normals);
  std::vector<Texel> stored;
  const auto store = [&](std::vector<std::byte>& bytes, const Texel* texels, size_t count) {
    if (normals) {
      stored.assign(texels, texels + count);
      for (Texel& t : stored) t[3] = slope_deviation(t);
      texels = stored.data();
    }
    append(bytes, texels, count, data.format);
  };
  if (!as_stored) {
    auto& bytes = data.levels.emplace_back();
    bytes.reserve(image.pixels.size());
    for (int y = 0; y < image.height; ++y) store(bytes, rows.row(y), size_t(image.width));
  }
  if (single) return data;
  for (Level level = half_size(rows);; level = half_size(StoredRows{level.width, level.height, level.texels.data()})) {
    store(data.levels.emplace_back(), level.texels.data(), level.texels.size());
    if (level.width == 1 && level.height == 1) break;
  }
  return finished();
}

void add_float_levels(gpu::TextureData& data) {
  CHECK(data.format == VK_FORMAT_R32G32B32A32_SFLOAT);
  int width = int(data.width), height = int(data.height);
  size_t count = 1;
  for (; width > 1 || height > 1; ++count) {
    if (data.levels.size() == count) data.levels.emplace_back();
    const StoredRows rows{width, height, reinterpret_cast<const Texel*>(data.levels[count - 1].data())};
    width = std::max(1, width / 2), height = std::max(1, height / 2);
    data.levels[count].resize(size_t(width) * size_t(height) * sizeof(Texel));
    half_size(rows, reinterpret_cast<Texel*>(data.levels[count].data()), 0, height);
  }
  data.levels.resize(count);
}

}  // namespace candela
