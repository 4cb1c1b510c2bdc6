#include "image/webp.h"

#include <webp/decode.h>

#include <cstring>

#include "image/bit_reader.h"

namespace candela {
namespace {

const char* webp_damage(VP8StatusCode status) {
  switch (status) {
    case VP8_STATUS_OUT_OF_MEMORY:
      throw std::bad_alloc();
    case VP8_STATUS_NOT_ENOUGH_DATA:
      return "the file is truncated";
    case VP8_STATUS_UNSUPPORTED_FEATURE:
      return "it uses what the decoder does not have";
    default:
      return "its stream is broken";
  }
}

}  // namespace

bool is_webp(std::span<const std::byte> bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

Expected<ImageInfo> probe_webp(std::span<const std::byte> bytes, const std::string& place) {
  // Lossless streams may end early and decode all the same.
  if (bytes.size() - 8 < little_endian<uint32_t>(bytes, 4))
    return fail(ErrorKind::input, place, "the WebP is truncated");
  WebPBitstreamFeatures features;
  const VP8StatusCode status = WebPGetFeatures(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), &features);
  if (status != VP8_STATUS_OK)
    return fail(ErrorKind::input, place, "the head of the WebP is damaged: {}", webp_damage(status));
  if (features.has_animation) return fail(ErrorKind::input, place, "the WebP is a film; only still pictures are read");
  return ImageInfo{features.width, features.height, features.has_alpha ? 4 : 3, 8};
}

Expected<DecodedImage> decode_webp(std::span<const std::byte> bytes, const std::string& place) {
  const auto info = probe_webp(bytes, place);
  if (!info) return std::unexpected(info.error());
  DecodedImage image{info->width, info->height, DecodedImage::Format::rgba8, info->channels, {}};
  image.pixels.resize(size_t(info->width) * size_t(info->height) * 4);
  WebPDecoderConfig config;
  if (!WebPInitDecoderConfig(&config)) return fail(ErrorKind::input, place, "libwebp is of another version");
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {reinterpret_cast<uint8_t*>(image.pixels.data()), info->width * 4, image.pixels.size()};
  const VP8StatusCode status = WebPDecode(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), &config);
  if (status != VP8_STATUS_OK) return fail(ErrorKind::input, place, "the WebP is damaged: {}", webp_damage(status));
  return image;
}

}  // namespace candela
