#include "image/io.h"

#include <cstring>

#include "base/files.h"
#include "base/input.h"
#include "image/exr.h"
#include "image/hdr.h"
#include "image/ktx2.h"
#include "image/oiio.h"
#include "image/png_text.h"
#include "image/png_write.h"
#include "image/prepare.h"
#include "image/seal.h"
#include "image/webp.h"

namespace candela {
namespace {

FloatImage from_interleaved(const float* pixels, int width, int height, int channels,
                            const std::vector<std::string>& names, int stride) {
  FloatImage image{.width = width, .height = height};
  const size_t count = size_t(width) * size_t(height);
  for (int c = 0; c < channels; ++c) {
    Channel& channel = image.channels.emplace_back();
    channel.name = names[size_t(c)];
    channel.f.resize(count);
    for (size_t i = 0; i < count; ++i) channel.f[i] = pixels[i * size_t(stride) + size_t(c)];
  }
  return image;
}

// Grey stays one channel (Y, as OpenEXR names luminance), so that a comparison sees the difference from colour.
FloatImage from_decoded(const DecodedImage& decoded) {
  const size_t count = decoded.pixels.size() / (decoded.format == DecodedImage::Format::rgba8    ? 1
                                                : decoded.format == DecodedImage::Format::rgba16 ? 2
                                                                                                 : 4);
  std::vector<float> values(count);
  if (decoded.format == DecodedImage::Format::rgba32f) {
    std::memcpy(values.data(), decoded.pixels.data(), decoded.pixels.size());
  } else if (decoded.format == DecodedImage::Format::rgba16) {
    const auto* codes = reinterpret_cast<const uint16_t*>(decoded.pixels.data());
    for (size_t i = 0; i < count; ++i) values[i] = float(codes[i]) / 65535.0f;
  } else {
    for (size_t i = 0; i < count; ++i) values[i] = float(uint8_t(decoded.pixels[i])) / 255.0f;
  }
  const int width = decoded.width, height = decoded.height;
  switch (decoded.source_channels) {
    case 1:
      return from_interleaved(values.data(), width, height, 1, {"Y"}, 4);
    case 2: {
      FloatImage image = from_interleaved(values.data(), width, height, 4, {"Y", "", "", "A"}, 4);
      image.channels.erase(image.channels.begin() + 1, image.channels.begin() + 3);
      return image;
    }
    case 3:
      return from_interleaved(values.data(), width, height, 3, {"R", "G", "B"}, 4);
    default:
      return from_interleaved(values.data(), width, height, 4, {"R", "G", "B", "A"}, 4);
  }
}

struct ReadTarget {
  int width = 0, height = 0, channels = 0;
  std::vector<std::string> names;
  std::vector<float> pixels;
  std::string place;
  Expected<void> fits;
};

float* begin_read(void* context, int width, int height, int channels, const char* names) {
  constexpr int64_t max_values = int64_t(1) << 31;
  auto& target = *static_cast<ReadTarget*>(context);
  if (width <= 0 || height <= 0 || channels <= 0 || width > max_exr_side || height > max_exr_side ||
      int64_t(width) * height > max_values / channels)
    return nullptr;
  uint64_t decoded = 0;  // interleaved here, then by channel
  target.fits = charge_decoded(decoded, 8 * uint64_t(width) * uint64_t(height) * uint64_t(channels), target.place);
  if (!target.fits) return nullptr;
  target.width = width, target.height = height, target.channels = channels;
  std::string_view rest = names;
  for (int c = 0; c < channels; ++c) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    target.names.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  target.pixels.resize(size_t(width) * size_t(height) * size_t(channels));
  return target.pixels.data();
}

Expected<FloatImage> read_through_module(const std::filesystem::path& path) {
  auto table = open_oiio(path.string());
  if (!table) return std::unexpected(table.error());
  ReadTarget target{.place = path.string()};
  std::array<char, 512> reason{};
  if ((*table)->read(path.c_str(), begin_read, &target, reason.data(), reason.size()) != 0) {
    if (!target.fits) return std::unexpected(target.fits.error());
    return fail(ErrorKind::input, path.string(), "is not a readable image: {}", reason.data());
  }
  return from_interleaved(target.pixels.data(), target.width, target.height, target.channels, target.names,
                          target.channels);
}

bool is_texture_format(std::span<const std::byte> bytes) {
  const auto starts = [&](const char* with) { return bytes.size() >= 3 && std::memcmp(bytes.data(), with, 3) == 0; };
  return starts("\x89PN") || starts("\xff\xd8\xff") || is_hdr(bytes) || is_webp(bytes) || is_ktx2(bytes);
}

}  // namespace

Expected<PreparedFile> prepare_png(const std::filesystem::path& path, const DisplayView& image,
                                   const std::vector<PngText>& texts) {
  auto encoded = encode_png(image, path.string());
  if (!encoded) return std::unexpected(encoded.error());
  std::vector<std::byte> file = std::move(*encoded);
  bool sealed = false;
  for (const auto& [keyword, text] : texts) {
    file = with_png_text(file, keyword, text);
    sealed |= keyword == seal_name;
  }
  if (sealed) seal_file(file);
  return prepare_file(path, std::span<const std::byte>(file));
}

Expected<void> write_png(const std::filesystem::path& path, const DisplayImage& image,
                         const std::vector<PngText>& texts) {
  auto prepared = prepare_png(path, view_of(image), texts);
  if (!prepared) return std::unexpected(prepared.error());
  return prepared->put_in_place();
}

Expected<FloatImage> read_image(const std::filesystem::path& path) {
  auto bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  if (is_exr(*bytes)) return decode_exr(*bytes, path.string());
  if (!is_texture_format(*bytes)) return read_through_module(path);
  auto decoded = decode_image(*bytes, path.string(), max_exr_side);
  if (!decoded) return std::unexpected(decoded.error());
  return from_decoded(*decoded);
}

}  // namespace candela
