#include "image/png_write.h"

#include <tbb/parallel_for.h>

#include <array>
#include <string_view>

#include "base/check.h"
#include "image/deflate.h"
#include "image/file_threads.h"
#include "image/png_filter.h"
#include "image/png_text.h"

namespace candela {
namespace {

void put_word(std::vector<std::byte>& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(std::byte(value >> shift));
}

// Opens a chunk; closing it fills in its length and adds its checksum.
class Chunk {
 public:
  Chunk(std::vector<std::byte>& out, std::string_view type) : out_(out), begin_(out.size()) {
    put_word(out, 0);
    for (const char c : type) out.push_back(std::byte(c));
  }
  ~Chunk() = default;
  Chunk(const Chunk&) = delete;
  Chunk& operator=(const Chunk&) = delete;
  void close() {
    const size_t length = out_.size() - begin_ - 8;
    CHECK(length < size_t(1) << 31);
    for (size_t i = 0; i < 4; ++i) out_[begin_ + i] = std::byte(length >> (24 - 8 * i));
    put_word(out_, png_crc(std::span(out_).subspan(begin_ + 4)));
  }

 private:
  std::vector<std::byte>& out_;
  size_t begin_;
};

void put_words(std::vector<std::byte>& out, std::string_view type, std::span<const uint32_t> words) {
  Chunk chunk(out, type);
  for (const uint32_t word : words) put_word(out, word);
  chunk.close();
}

// sRGB, and for readers that do not know it the gamma and primaries that the PNG specification gives for it.
void put_colour(std::vector<std::byte>& out) {
  put_words(out, "gAMA", std::array<uint32_t, 1>{45455});
  Chunk chunk(out, "sRGB");
  out.push_back(std::byte{1});  // relative colorimetric
  chunk.close();
  put_words(out, "cHRM", std::array<uint32_t, 8>{31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000});
}

std::vector<std::byte> filtered(const DisplayView& image, bool threads) {
  const size_t row = 1 + size_t(image.width) * size_t(image.channels) * size_t(image.bits / 8);
  std::vector<std::byte> rows(row * size_t(image.height));
  constexpr int part = 32;
  const int parts = (image.height + part - 1) / part;
  const auto filter = [&](int i) {
    const int first = i * part, last = std::min(first + part, image.height);
    filter_png_rows(image, first, last, rows.data() + size_t(first) * row);
  };
  if (threads)
    tbb::parallel_for(0, parts, filter);
  else
    for (int i = 0; i < parts; ++i) filter(i);
  return rows;
}

}  // namespace

Expected<std::vector<std::byte>> encode_png(const DisplayView& image, const std::string& place) try {
  CHECK(image.width > 0 && image.height > 0 && (image.channels == 3 || image.channels == 4) &&
        (image.bits == 8 || image.bits == 16));
  CHECK(image.row_bytes >= size_t(image.width) * size_t(image.channels) * size_t(image.bits / 8));
  std::vector<std::byte> out;
  for (const uint8_t byte : {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a}) out.push_back(std::byte(byte));
  Chunk header(out, "IHDR");
  put_word(out, uint32_t(image.width));
  put_word(out, uint32_t(image.height));
  for (const int value : {image.bits, image.channels == 4 ? 6 : 2, 0, 0, 0}) out.push_back(std::byte(value));
  header.close();
  put_colour(out);
  const bool threads = file_threads();
  const std::vector<std::byte> pixels = zlib_stream(filtered(image, threads), threads);
  out.reserve(out.size() + pixels.size() + pixels.size() / 4096 + 64);
  constexpr size_t most = size_t(1) << 30;  // of a chunk
  for (size_t from = 0; from < pixels.size(); from += most) {
    Chunk chunk(out, "IDAT");
    const auto part = std::span(pixels).subspan(from, std::min(most, pixels.size() - from));
    out.insert(out.end(), part.begin(), part.end());
    chunk.close();
  }
  Chunk end(out, "IEND");
  end.close();
  return out;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to encode PNG");
}

}  // namespace candela
