#include "gltf/meshopt_vertices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace candela::gltf {
namespace {

constexpr size_t group_size = 16, most_in_block = 256;

// The bytes of a stream one after the other; asking for more than there are fails for good.
class Stream {
 public:
  explicit Stream(std::span<const std::byte> bytes) : bytes_(bytes) {}
  // Null: there are not so many.
  const uint8_t* take(size_t count) {
    if (count > bytes_.size()) return nullptr;
    const auto* at = reinterpret_cast<const uint8_t*>(bytes_.data());
    bytes_ = bytes_.subspan(count);
    return at;
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

// 16 differences of `width` bits, those that do not fit as bytes behind them.
bool read_group(Stream& stream, uint32_t width, uint8_t* out) {
  if (width == 0) {
    std::fill_n(out, group_size, uint8_t(0));
    return true;
  }
  const uint8_t* const packed = stream.take(group_size * width / 8);
  if (!packed) return false;
  const uint32_t outside = (1u << width) - 1, in_byte = 8 / width;
  for (uint32_t i = 0; i < group_size; ++i) {
    // Single bits begin with the lowest, pairs and nibbles with the highest.
    const uint32_t place = width == 1 ? i % in_byte : in_byte - 1 - i % in_byte;
    out[i] = uint8_t(packed[i / in_byte] >> (place * width) & outside);
  }
  if (width < 8)
    for (uint32_t i = 0; i < group_size; ++i)
      if (out[i] == outside) {
        const uint8_t* const whole = stream.take(1);
        if (!whole) return false;
        out[i] = *whole;
      }
  return true;
}

// The differences of one byte of the elements of a block.
bool read_plane(Stream& stream, uint32_t control, size_t count, uint8_t* out) {
  static constexpr uint8_t widths[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 8}};
  constexpr uint32_t zeros = 2, plain = 3;
  if (control == zeros) {
    std::fill_n(out, count, uint8_t(0));
    return true;
  }
  if (control == plain) {
    const uint8_t* const bytes = stream.take(count);
    if (bytes) std::copy_n(bytes, count, out);
    return bytes;
  }
  const size_t groups = (count + group_size - 1) / group_size;
  const uint8_t* const heads = stream.take((groups + 3) / 4);
  if (!heads) return false;
  for (size_t g = 0; g < groups; ++g)
    if (!read_group(stream, widths[control][heads[g / 4] >> (g % 4 * 2) & 3], out + g * group_size)) return false;
  return true;
}

template <class T>
T unfolded(T v) {
  return T(v & 1 ? ~(v >> 1) : v >> 1);
}

// The element's four bytes from those of the one before.
uint32_t next_value(uint32_t before, uint32_t difference, uint32_t mode) {
  const uint32_t kind = mode & 15;
  if (kind == 2) return before ^ std::rotr(difference, int(mode >> 4));
  uint32_t value = 0;
  if (kind == 1)
    for (int at : {0, 16}) value |= uint32_t(uint16_t((before >> at) + unfolded(uint16_t(difference >> at)))) << at;
  else
    for (int at : {0, 8, 16, 24})
      value |= uint32_t(uint8_t((before >> at) + unfolded(uint8_t(difference >> at)))) << at;
  return value;
}

template <class T, class Signed>
void decode_colors(std::span<std::byte> out) {
  constexpr float largest = float(T(~T(0)));
  for (size_t at = 0; at + 4 * sizeof(T) <= out.size(); at += 4 * sizeof(T)) {
    std::array<T, 4> v;
    std::memcpy(v.data(), out.data() + at, sizeof v);
    const int bits = std::bit_width(v[3]), most = (1 << bits) - 1;
    const int y = v[0], co = Signed(v[1]), cg = Signed(v[2]), a = v[3] & (most >> 1);
    const float scale = most > 0 ? largest / float(most) : 0;
    const int colour[] = {y + co - cg, y + cg, y - co - cg, a << 1 | (a & 1)};
    for (size_t c = 0; c < 4; ++c) v[c] = T(std::clamp(std::round(float(colour[c]) * scale), 0.0f, largest));
    std::memcpy(out.data() + at, v.data(), sizeof v);
  }
}

}  // namespace

bool is_vertices_v1(std::span<const std::byte> stream) { return !stream.empty() && stream[0] == std::byte(0xa1); }

bool decode_vertices_v1(std::span<const std::byte> stream, size_t stride, std::span<std::byte> out) {
  const size_t channels = stride / 4, tail = std::max<size_t>(stride + channels, 24);
  if (!is_vertices_v1(stream) || stream.size() < 1 + tail) return false;
  const auto end = stream.last(stride + channels);  // the element before the first, then a mode for each channel
  std::array<uint32_t, 64> before, modes;
  for (size_t c = 0; c < channels; ++c) {
    std::memcpy(&before[c], end.data() + 4 * c, 4);
    modes[c] = uint32_t(end[stride + c]);
    if ((modes[c] & 15) > 2 || ((modes[c] & 15) < 2 && modes[c] >> 4 != 0)) return false;
  }
  Stream data(stream.subspan(1, stream.size() - 1 - tail));
  std::array<std::array<uint8_t, most_in_block>, 4> planes;
  const size_t in_block = std::min<size_t>((8192 / stride) & ~(group_size - 1), most_in_block);
  for (size_t first = 0, total = out.size() / stride; first < total; first += in_block) {
    const size_t count = std::min(in_block, total - first);
    const uint8_t* const controls = data.take(channels);
    if (!controls) return false;
    for (size_t c = 0; c < channels; ++c) {
      for (size_t byte = 0; byte < 4; ++byte)
        if (!read_plane(data, controls[c] >> (2 * byte) & 3, count, planes[byte].data())) return false;
      for (size_t i = 0; i < count; ++i) {
        const uint32_t difference = uint32_t(planes[0][i]) | uint32_t(planes[1][i]) << 8 |
                                    uint32_t(planes[2][i]) << 16 | uint32_t(planes[3][i]) << 24;
        before[c] = next_value(before[c], difference, modes[c]);
        std::memcpy(out.data() + (first + i) * stride + 4 * c, &before[c], 4);
      }
    }
  }
  return data.at_end();
}

void decode_filter_color(std::span<std::byte> out, size_t stride) {
  if (stride == 4)
    decode_colors<uint8_t, int8_t>(out);
  else
    decode_colors<uint16_t, int16_t>(out);
}

}  // namespace candela::gltf
