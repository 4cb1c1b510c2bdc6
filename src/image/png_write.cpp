// PNG through libpng. Its errors leave by longjmp, which may not pass over a C++ object that has a destructor: the one
// function that calls setjmp and everything below it therefore hold plain values and pointers only.
#include "image/png_write.h"

#include <png.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "base/check.h"

namespace candela {
namespace {

// Measured on renders (docs/decisions.md).
constexpr int compression_level = 4;

struct Sink {
  std::vector<std::byte> bytes;
  bool out_of_memory = false;
  std::array<char, 256> reason{};
};

void on_error(png_structp png, png_const_charp message) {
  auto& sink = *static_cast<Sink*>(png_get_error_ptr(png));
  std::snprintf(sink.reason.data(), sink.reason.size(), "%s", message);
  png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

bool append(Sink& sink, const png_byte* data, size_t size) noexcept try {
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  sink.bytes.insert(sink.bytes.end(), bytes, bytes + size);
  return true;
} catch (const std::bad_alloc&) {
  sink.out_of_memory = true;
  return false;
}
void on_write(png_structp png, png_bytep data, size_t size) {
  if (!append(*static_cast<Sink*>(png_get_io_ptr(png)), data, size)) png_error(png, "not enough memory");
}
void on_flush(png_structp) {}

// False: the reason lies in the sink.
bool encode(const DisplayView& image, Sink& sink) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info) {
    png_destroy_write_struct(&png, nullptr);
    sink.out_of_memory = true;
    return false;
  }
  if (setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &sink, on_write, on_flush);
  png_set_compression_level(png, compression_level);
  png_set_IHDR(png, info, png_uint_32(image.width), png_uint_32(image.height), image.bits,
               image.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE);
  png_write_info(png, info);
  if (image.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  const auto* row = reinterpret_cast<png_const_bytep>(image.pixels);
  for (int y = 0; y < image.height; ++y, row += image.row_bytes) png_write_row(png, row);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

Expected<std::vector<std::byte>> encode_png(const DisplayView& image, const std::string& place) {
  CHECK(image.width > 0 && image.height > 0 && (image.channels == 3 || image.channels == 4) &&
        (image.bits == 8 || image.bits == 16));
  CHECK(image.row_bytes >= size_t(image.width) * size_t(image.channels) * size_t(image.bits / 8));
  Sink sink;
  if (encode(image, sink)) return std::move(sink.bytes);
  if (sink.out_of_memory) return fail(ErrorKind::out_of_memory, place, "not enough memory to encode PNG");
  return fail(ErrorKind::output, place, "cannot encode PNG: {}", sink.reason.data());
}

}  // namespace candela
