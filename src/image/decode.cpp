// Images in memory, by how they begin; PNG and JPEG through stb_image. Only files that begin as one of the two reach
// it, so that its decoders of other formats are never entered; what it does not notice (truncated JPEG, sizes no file
// of that length can hold) is refused here. It is compiled here rather than linked: its memory begins as zeros, for a
// JPEG whose scan names a Huffman table that it never defined is decoded by whatever lies there, and what it asserts is
// an error of the file.
#include <climits>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(block, size) std::realloc(block, size)
#define STBI_FREE(block) std::free(block)
#define STBI_ASSERT(condition) ((condition) ? void() : throw std::logic_error(#condition))
#include <stb/stb_image.h>

#include "base/input.h"
#include "image/environment_file.h"
#include "image/hdr.h"
#include "image/io.h"
#include "image/ktx2.h"
#include "image/png_text.h"
#include "image/webp.h"

namespace candela {
namespace {

enum class Encoding { unknown, png, jpeg, hdr, webp, ktx2 };

Encoding encoding_of(std::span<const std::byte> bytes) {
  static constexpr uint8_t png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  static constexpr uint8_t jpeg[] = {0xff, 0xd8, 0xff};
  if (bytes.size() >= 8 && std::memcmp(bytes.data(), png, 8) == 0) return Encoding::png;
  if (bytes.size() >= 3 && std::memcmp(bytes.data(), jpeg, 3) == 0) return Encoding::jpeg;
  return is_hdr(bytes)    ? Encoding::hdr
         : is_webp(bytes) ? Encoding::webp
         : is_ktx2(bytes) ? Encoding::ktx2
                          : Encoding::unknown;
}

uint32_t big_endian(std::span<const std::byte> bytes, size_t at, int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | uint32_t(bytes[at + size_t(i)]);
  return value;
}

// Nothing when the chunks of the PNG reach its IEND and those that pixels are made of are what was written, else what
// is wrong. stb stops at IEND too, but reads zeros past the end, and looks at no checksum.
std::string check_png_chunks(std::span<const std::byte> bytes) {
  for (size_t at = 8; bytes.size() - at >= 12;) {
    const uint64_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - 12) return "the file is truncated";
    const bool critical = (bytes[at + 4] & std::byte(0x20)) == std::byte(0);  // a capital letter
    const size_t end = at + 8 + size_t(length);
    if (critical && png_crc(bytes.subspan(at + 4, size_t(length) + 4)) != big_endian(bytes, end, 4))
      return "a checksum is wrong";
    if (std::memcmp(bytes.data() + at + 4, "IEND", 4) == 0) return {};
    at += 12 + size_t(length);
  }
  return "the file is truncated";
}

// Walks the markers of a JPEG to its end marker. stb takes a truncated file for grey pixels. A file of very many scans
// would walk over the whole image once for each; the most a progressive encoder has a use for is a few dozen.
std::string check_jpeg_markers(std::span<const std::byte> bytes) {
  constexpr int max_scans = 100;
  int scans = 0;
  for (size_t at = 2; at + 2 <= bytes.size();) {
    if (bytes[at] != std::byte(0xff)) {  // entropy-coded data
      ++at;
      continue;
    }
    const auto marker = uint8_t(bytes[at + 1]);
    if (marker == 0xd9) return {};
    if (marker == 0xff) {
      ++at;
      continue;
    }
    at += 2;
    if (marker == 0x00 || marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) continue;
    if (at + 2 > bytes.size()) break;
    const uint32_t length = big_endian(bytes, at, 2);
    if (length < 2) return "a segment has no length";
    if (length > bytes.size() - at) break;
    if (marker == 0xda && ++scans > max_scans) return fmt::format("more than {} scans", max_scans);
    at += length;
  }
  return "the file is truncated";
}

// The rule for sizes out of proportion. PNG: deflate yields at most 1032 bytes for one. JPEG: each block of 64 pixels
// costs a bit at least, and subsampling can leave half of the pixels to one of two components: 1024 pixels for a byte.
bool can_hold(Encoding encoding, std::span<const std::byte> bytes, int width, int height) {
  const uint64_t pixels = uint64_t(width) * uint64_t(height);
  if (encoding == Encoding::jpeg) return pixels / 1024 <= bytes.size();
  static constexpr int components[] = {1, 1, 3, 1, 2, 1, 4, 1};
  const int bits = int(bytes[24]) * components[int(bytes[25]) & 7];
  const uint64_t row = 1 + (uint64_t(width) * uint64_t(bits) + 7) / 8;
  return row * uint64_t(height) / 1032 <= bytes.size();
}

Expected<ImageInfo> read_head(std::span<const std::byte> encoded, const std::string& place) {
  const Encoding encoding = encoding_of(encoded);
  if (encoding == Encoding::hdr) return probe_hdr(encoded, place);
  if (encoding == Encoding::webp) return probe_webp(encoded, place);
  if (encoding == Encoding::ktx2) return probe_ktx2(encoded, place);
  if (encoding == Encoding::unknown)
    return fail(ErrorKind::input, place, "is neither PNG, JPEG, WebP, KTX2 nor Radiance HDR");
  if (encoded.size() > size_t(INT_MAX)) return fail(ErrorKind::input, place, "is larger than 2 GiB");
  const auto* data = reinterpret_cast<const stbi_uc*>(encoded.data());
  ImageInfo info;
  if (!stbi_info_from_memory(data, int(encoded.size()), &info.width, &info.height, &info.channels))
    return fail(ErrorKind::input, place, "the head of the {} is damaged: {}",
                encoding == Encoding::png ? "PNG" : "JPEG", stbi_failure_reason());
  if (encoding == Encoding::png && stbi_is_16_bit_from_memory(data, int(encoded.size()))) info.bits = 16;
  if (info.width <= 0 || info.height <= 0) return fail(ErrorKind::input, place, "has no pixels");
  return info;
}

}  // namespace

Expected<ImageInfo> probe_image(std::span<const std::byte> encoded, const std::string& place) {
  constexpr uint64_t free_pixels = uint64_t(1) << 24, pixels_per_byte = 64;
  auto info = read_head(encoded, place);
  if (!info) return info;
  const uint64_t pixels = uint64_t(info->width) * uint64_t(info->height);
  if (pixels > free_pixels && pixels > pixels_per_byte * encoded.size())
    return fail(ErrorKind::input, place,
                "{}x{} pixels from {} bytes are out of proportion: above {} pixels at most {} for a byte are decoded",
                info->width, info->height, encoded.size(), free_pixels, pixels_per_byte);
  return info;
}

uint64_t decoded_bytes(const ImageInfo& info) {
  return uint64_t(info.width) * uint64_t(info.height) * 4 * uint64_t(info.bits / 8);
}

Expected<DecodedImage> decode_image(std::span<const std::byte> encoded, const std::string& place, int max_side) try {
  const Encoding encoding = encoding_of(encoded);
  const auto info = probe_image(encoded, place);
  if (!info) return std::unexpected(info.error());
  uint64_t decoded = 0;
  if (auto fits = charge_decoded(decoded, decoded_bytes(*info), place); !fits) return std::unexpected(fits.error());
  if (encoding == Encoding::hdr) return decode_hdr(encoded, place, max_side);
  if (info->width > max_side || info->height > max_side)
    return fail(ErrorKind::input, place, "{}x{} pixels are more than {} on a side", info->width, info->height,
                max_side);
  if (encoding == Encoding::webp) return decode_webp(encoded, place);
  if (encoding == Encoding::ktx2) return decode_ktx2(encoded, place);
  const std::string damage = encoding == Encoding::png ? check_png_chunks(encoded) : check_jpeg_markers(encoded);
  if (!damage.empty()) return fail(ErrorKind::input, place, "is damaged: {}", damage);
  if (!can_hold(encoding, encoded, info->width, info->height))
    return fail(ErrorKind::input, place, "{}x{} pixels cannot be held by {} bytes", info->width, info->height,
                encoded.size());
  const auto* data = reinterpret_cast<const stbi_uc*>(encoded.data());
  const int size = int(encoded.size());
  DecodedImage image;
  image.format = info->bits == 16 ? DecodedImage::Format::rgba16 : DecodedImage::Format::rgba8;
  void* pixels = info->bits == 16 ? static_cast<void*>(stbi_load_16_from_memory(data, size, &image.width, &image.height,
                                                                                &image.source_channels, 4))
                                  : static_cast<void*>(stbi_load_from_memory(data, size, &image.width, &image.height,
                                                                             &image.source_channels, 4));
  if (!pixels) return fail(ErrorKind::input, place, "is damaged: {}", stbi_failure_reason());
  const std::unique_ptr<void, decltype(&stbi_image_free)> owner(pixels, stbi_image_free);
  const auto* bytes = static_cast<const std::byte*>(pixels);
  image.pixels.assign(bytes, bytes + size_t(image.width) * size_t(image.height) * size_t(info->bits / 2));
  return image;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to decode the image");
} catch (const std::logic_error& broken) {
  return fail(ErrorKind::input, place, "is damaged: the decoder refuses it ({})", broken.what());
}

}  // namespace candela
