#include "image/png_filter.h"

#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>

namespace candela {
namespace {

constexpr int filters = 5;

// One row and the one above it, in the file's order of bytes, each with a pixel of zeros before it.
struct Rows {
  Rows(size_t row_bytes, size_t pixel)
      : pixel_bytes(pixel), count(row_bytes), now(pixel + row_bytes), above(pixel + row_bytes) {}
  size_t pixel_bytes, count;
  std::vector<uint8_t> now, above;
};

void load(const DisplayView& image, int y, std::vector<uint8_t>& row, size_t pixel, size_t count) {
  const std::byte* from = image.pixels + size_t(y) * image.row_bytes;
  uint8_t* to = row.data() + pixel;
  std::memcpy(to, from, count);
  if (image.bits == 16 && std::endian::native == std::endian::little)
    for (size_t i = 0; i + 1 < count; i += 2) {
      const uint8_t low = to[i];
      to[i] = to[i + 1], to[i + 1] = low;
    }
}

int16_t paeth(int16_t a, int16_t b, int16_t c) {
  const int16_t to_a = int16_t(b - c), to_b = int16_t(a - c), both = int16_t(to_a + to_b);
  const int16_t da = int16_t(to_a < 0 ? -to_a : to_a), db = int16_t(to_b < 0 ? -to_b : to_b),
                dc = int16_t(both < 0 ? -both : both);
  const int16_t of_two = db <= dc ? b : c;
  return da <= db && da <= dc ? a : of_two;
}

// In loops that compilers turn into vectors.
void filtered(int filter, const Rows& rows, uint8_t* out) {
  const uint8_t* now = rows.now.data() + rows.pixel_bytes;
  const uint8_t* above = rows.above.data() + rows.pixel_bytes;
  const uint8_t *left = rows.now.data(), *corner = rows.above.data();
  const size_t n = rows.count;
  switch (filter) {
    case 0:
      std::memcpy(out, now, n);
      break;
    case 1:
      for (size_t i = 0; i < n; ++i) out[i] = uint8_t(now[i] - left[i]);
      break;
    case 2:
      for (size_t i = 0; i < n; ++i) out[i] = uint8_t(now[i] - above[i]);
      break;
    case 3:
      for (size_t i = 0; i < n; ++i) out[i] = uint8_t(now[i] - ((left[i] + above[i]) >> 1));
      break;
    default:
      for (size_t i = 0; i < n; ++i) out[i] = uint8_t(now[i] - paeth(left[i], above[i], corner[i]));
      break;
  }
}

// Differences are whole numbers around 0, and bytes of them.
uint64_t cost(const uint8_t* bytes, size_t n) {
  uint64_t sum = 0;
  constexpr size_t block = 256;  // whose sum fits 16 bits
  for (size_t from = 0; from < n; from += block) {
    uint16_t part = 0;
    const size_t end = from + block < n ? from + block : n;
    for (size_t i = from; i < end; ++i) {
      const uint8_t v = bytes[i], opposite = uint8_t(-v);
      part = uint16_t(part + (v < opposite ? v : opposite));
    }
    sum += part;
  }
  return sum;
}

}  // namespace

void filter_png_rows(const DisplayView& image, int first, int last, std::byte* out) {
  const size_t pixel = size_t(image.channels) * size_t(image.bits / 8), count = pixel * size_t(image.width);
  Rows rows(count, pixel);
  if (first > 0) load(image, first - 1, rows.above, pixel, count);
  std::array<std::vector<uint8_t>, filters> tries;
  for (auto& each : tries) each.resize(count);
  for (int y = first; y < last; ++y, out += 1 + count) {
    load(image, y, rows.now, pixel, count);
    int best = 0;
    uint64_t least = ~uint64_t(0);
    for (int filter = 0; filter < filters; ++filter) {
      filtered(filter, rows, tries[size_t(filter)].data());
      const uint64_t sum = cost(tries[size_t(filter)].data(), count);
      if (sum < least) least = sum, best = filter;
    }
    out[0] = std::byte(best);
    std::memcpy(out + 1, tries[size_t(best)].data(), count);
    std::swap(rows.now, rows.above);
  }
}

}  // namespace candela
