#include <gtest/gtest.h>
#include <zlib.h>

#include "base/rng.h"
#include "image/deflate.h"
#include "image/io.h"
#include "image/png_filter.h"
#include "image/png_text.h"
#include "image/png_write.h"
#include "image/prepare.h"

namespace candela {
namespace {

// By zlib, whose checksum of the content must hold and behind which nothing may stand.
std::vector<std::byte> inflated(const std::vector<std::byte>& stream, size_t size) {
  std::vector<std::byte> out(size + 1);
  uLongf bytes = out.size(), taken = stream.size();
  const int result =
      uncompress2(reinterpret_cast<Bytef*>(out.data()), &bytes, reinterpret_cast<const Bytef*>(stream.data()), &taken);
  EXPECT_EQ(result, Z_OK) << "of " << size << " bytes";
  EXPECT_EQ(taken, stream.size());
  out.resize(bytes);
  return out;
}

// Kinds of content: one value, noise of so many bits, few values far apart (long codes), runs, periods, far repeats.
std::vector<std::byte> content(int kind, size_t size, uint64_t seed) {
  Rng rng(seed);
  std::vector<std::byte> bytes(size);
  for (size_t i = 0; i < size; ++i) {
    uint64_t v = 0;
    if (kind == 1) v = rng.next();
    if (kind == 2) v = rng.next() & 3;
    if (kind == 3) v = uint64_t(std::countr_zero(rng.next() | (uint64_t(1) << 40)));  // halved from value to value
    if (kind == 4) v = i / 300;
    if (kind == 5) v = i % 7;
    if (kind == 6) v = i < 40000 ? rng.next() : uint64_t(bytes[i - 32768]);
    if (kind == 7) v = i < 40000 ? rng.next() : uint64_t(bytes[i - 32769]);
    if (kind == 8) v = rng.next() % 50 ? uint64_t(i > 0 ? uint8_t(bytes[i - 1]) : 0) : rng.next();
    bytes[i] = std::byte(v);
  }
  return bytes;
}

TEST(Deflate, ComesBackAsItWas) {
  for (const size_t size :
       {0, 1, 2, 3, 7, 8, 9, 63, 258, 259, 1000, 65535, 65536, 65537, 131071, 131072, 131073, 400000})
    for (int kind = 0; kind <= 8; ++kind) {
      const std::vector<std::byte> bytes = content(kind, size, size + uint64_t(kind));
      const std::vector<std::byte> stream = zlib_stream(bytes, false);
      EXPECT_EQ(inflated(stream, size), bytes) << kind << " of " << size;
      EXPECT_LE(stream.size(), size + 64 + size / 1000) << "what cannot be compressed is stored: kind " << kind;
    }
}

TEST(Deflate, BytesDoNotDependOnThreads) {
  for (int kind = 0; kind <= 8; ++kind) {
    const std::vector<std::byte> bytes = content(kind, 700001, 5);
    EXPECT_EQ(zlib_stream(bytes, true), zlib_stream(bytes, false)) << kind;
  }
}

TEST(Deflate, FindsRepeats) {
  EXPECT_LT(zlib_stream(content(0, 400000, 1), false).size(), 2500u);
  EXPECT_LT(zlib_stream(content(5, 400000, 1), false).size(), 2500u);
  EXPECT_LT(zlib_stream(content(6, 120000, 1), false).size(), 50000u) << "as far as the window goes";
  EXPECT_GT(zlib_stream(content(7, 120000, 1), false).size(), 119000u) << "and no farther";
  EXPECT_LT(zlib_stream(content(2, 400000, 1), false).size(), 115000u) << "two bits of eight";
}

// Weights of a Fibonacci series have the longest codes, which are cut to 15 bits.
TEST(Deflate, CodesAreNoLongerThanAllowed) {
  std::vector<std::byte> bytes;
  uint32_t a = 1, b = 1;
  for (int symbol = 0; bytes.size() + b < 65536; ++symbol) {
    bytes.insert(bytes.end(), b, std::byte(symbol));
    b += a, a = b - a;
  }
  Rng rng(2);
  for (size_t i = bytes.size(); i-- > 1;) std::swap(bytes[i], bytes[rng.next() % (i + 1)]);
  EXPECT_EQ(inflated(zlib_stream(bytes, false), bytes.size()), bytes);
}

// Undone by the definitions of the specification, a byte at a time.
TEST(PngFilter, RowsComeBackByTheSpecification) {
  for (const int channels : {3, 4})
    for (const int bits : {8, 16}) {
      DisplayImage image{.width = 37, .height = 20, .channels = channels, .bits = bits};
      Rng rng(4);
      const size_t row = row_bytes(image), pixel = size_t(channels * bits / 8);
      for (size_t i = 0; i < row * 20; ++i) {
        const size_t x = i % row, y = i / row;  // bands that suit each filter
        const uint64_t v = y < 4 ? x * 5 : y < 8 ? y * 60 + x % 3 : y < 12 ? x + y * 3 : rng.next();
        image.pixels.push_back(std::byte(v));
      }
      std::vector<std::byte> rows((1 + row) * 20), parts(rows.size());
      filter_png_rows(view_of(image), 0, 20, rows.data());
      for (int y = 0; y < 20; y += 3)
        filter_png_rows(view_of(image), y, std::min(y + 3, 20), parts.data() + size_t(y) * (1 + row));
      EXPECT_EQ(rows, parts);
      std::vector<uint8_t> above(row, 0), now(row);
      std::set<int> used;
      for (size_t y = 0; y < 20; ++y) {
        const std::byte* from = rows.data() + y * (1 + row);
        const int filter = int(from[0]);
        used.insert(filter);
        for (size_t i = 0; i < row; ++i) {
          const int a = i < pixel ? 0 : now[i - pixel], b = above[i], c = i < pixel ? 0 : above[i - pixel];
          const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
          const int by[] = {0, a, b, (a + b) / 2, pa <= pb && pa <= pc ? a : pb <= pc ? b : c};
          ASSERT_LE(filter, 4);
          now[i] = uint8_t(int(from[1 + i]) + by[filter]);
          const size_t native = bits == 16 ? i ^ 1 : i;
          ASSERT_EQ(std::byte(now[i]), image.pixels[y * row + native]) << filter << " " << y;
        }
        above = now;
      }
      EXPECT_GT(used.size(), 2u);
    }
}

TEST(Png, BytesDoNotDependOnThreadsOrOnRoomBetweenRows) {
  DisplayImage image{.width = 501, .height = 300, .channels = 3, .bits = 8};
  Rng rng(1);
  for (size_t i = 0; i < row_bytes(image) * 300; ++i) image.pixels.push_back(std::byte(i / 900 + (rng.next() & 1)));
  const auto with = encode_png(image, "");
  const bool before = set_file_threads(false);
  const auto without = encode_png(image, "");
  DisplayView view = view_of(image);
  std::vector<std::byte> wide(300 * 2000);
  for (size_t y = 0; y < 300; ++y) std::memcpy(&wide[y * 2000], &image.pixels[y * view.row_bytes], view.row_bytes);
  view.pixels = wide.data(), view.row_bytes = 2000;
  const auto apart = encode_png(view, "");
  set_file_threads(before);
  ASSERT_TRUE(with && without && apart);
  EXPECT_EQ(*with, *without);
  EXPECT_EQ(*with, *apart);
}

TEST(Png, ChecksumIsThatOfTheStandard) {
  const std::string digits = "123456789";
  EXPECT_EQ(png_crc(std::as_bytes(std::span(digits))), 0xcbf43926u);
  Rng rng(1);
  std::vector<std::byte> bytes(1000);
  for (std::byte& b : bytes) b = std::byte(rng.next());
  for (size_t n = 0; n < 1000; n += 37)
    EXPECT_EQ(png_crc(std::span(bytes).first(n)), crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), uInt(n)));
}

}  // namespace
}  // namespace candela
