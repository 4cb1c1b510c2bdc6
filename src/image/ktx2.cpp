// Khronos, "KTX File Format Specification 2.0" and "Data Format Specification 1.3".
#include "image/ktx2.h"

#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>

#include "image/etc1s.h"
#include "image/uastc.h"

namespace candela {
namespace {

using Bytes = std::span<const std::byte>;
template <class T>
using OrDamage = std::expected<T, std::string>;

template <class... A>
std::unexpected<std::string> damage(fmt::format_string<A...> format, A&&... args) {
  return std::unexpected(fmt::format(format, std::forward<A>(args)...));
}

constexpr std::array<uint8_t, 12> ktx2_start = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};

enum class Packing : uint32_t { none, basis_lz, zstandard, zlib };  // "supercompression"
enum class Channel8 : uint8_t {
  rgb = 0,
  uastc_rgba = 3,
  etc1s_red = 3,
  uastc_red = 4,
  etc1s_green = 4,
  uastc_red_alpha = 5,
  uastc_red_green = 6,
  etc1s_alpha = 15
};

// What of a file is used.
struct Ktx2File {
  uint32_t width = 0, height = 0, levels = 0;
  int plain_channels = 0;  // of texels of 8 bits a channel; 0: Basis Universal's
  bool uastc = false;      // else ETC1S
  Packing packing = Packing::none;
  Transfer transfer = Transfer::unsaid;
  std::array<Channel8, 2> channels = {};  // what each slice, or the only one, stands for
  uint32_t slices = 1;
  Bytes global, level;  // level 0

  int source_channels() const {
    if (plain_channels > 0) return plain_channels == 4 ? 4 : 3;
    if (slices == 2) return channels[1] == Channel8::etc1s_alpha ? 4 : 3;
    return uastc && channels[0] == Channel8::uastc_rgba ? 4 : 3;
  }
  uint64_t blocks() const { return uint64_t((width + 3) / 4) * ((height + 3) / 4); }
};

// Bytes of the file, or nothing when it does not have them.
std::optional<Bytes> part_of(Bytes file, uint64_t offset, uint64_t length) {
  if (offset > file.size() || length > file.size() - offset) return std::nullopt;
  return file.subspan(size_t(offset), size_t(length));
}

std::string read_texel_format(Bytes format, Ktx2File& file) {
  constexpr size_t head = 28, sample_bytes = 16;  // the total size, then the block's own head of 24
  if (format.size() < head + sample_bytes || little_endian<uint32_t>(format, 0) > format.size())
    return "the description of its texels is truncated";
  const size_t block_bytes = little_endian<uint16_t>(format, 10);
  if ((little_endian<uint32_t>(format, 4) != 0) || block_bytes < head - 4 + sample_bytes ||
      block_bytes > format.size() - 4)
    return "the description of its texels is damaged";
  constexpr uint8_t etc1s = 163, uastc = 166;
  const auto model = uint8_t(format[12]), transfer = uint8_t(format[14]), flags = uint8_t(format[15]);
  if (model != etc1s && model != uastc)
    return fmt::format("its texels are of color model {}; ETC1S (163) and UASTC (166) are read", model);
  file.uastc = model == uastc;
  file.transfer = transfer == 2 ? Transfer::srgb : transfer == 1 ? Transfer::linear : Transfer::unsaid;
  if (flags & 1) return "its colours are premultiplied by alpha, which glTF does not allow";
  file.slices = uint32_t((block_bytes - (head - 4)) / sample_bytes);
  if (file.slices > (file.uastc ? 1u : 2u)) return fmt::format("it has {} samples for a texel", file.slices);
  for (size_t i = 0; i < file.slices; ++i)
    file.channels[i] = Channel8(uint8_t(format[head + i * sample_bytes + 3]) & 15);
  using enum Channel8;
  const Channel8 first = file.channels[0], second = file.channels[1];
  const bool known = file.uastc ? first == rgb || first == uastc_rgba || first == uastc_red ||
                                      first == uastc_red_alpha || first == uastc_red_green
                     : file.slices == 1
                         ? first == rgb || first == etc1s_red
                         : (first == rgb && second == etc1s_alpha) || (first == etc1s_red && second == etc1s_green);
  return known ? "" : "its channels are none that KHR_texture_basisu has";
}

// Rows must run from the top, columns from the left, and channels must be in order.
std::string check_notes(Bytes notes) {
  while (notes.size() >= 4) {
    const uint32_t length = little_endian<uint32_t>(notes, 0);
    if (length > notes.size() - 4) return "its notes are truncated";
    const std::string_view note(reinterpret_cast<const char*>(notes.data()) + 4, length);
    const size_t end = note.find('\0');
    if (end == std::string_view::npos) return "an entry of its metadata has no name";
    const std::string_view name = note.substr(0, end);
    std::string_view text = note.substr(end + 1);
    text = text.substr(0, text.find('\0'));
    const std::string_view wanted = name == "KTXorientation" ? "rd" : name == "KTXswizzle" ? "rgba" : text;
    if (text != wanted) return fmt::format("its {} is '{}'; '{}' is read", name, text, wanted);
    notes = notes.subspan(std::min<size_t>(notes.size(), 4 + (size_t(length) + 3) / 4 * 4));
  }
  return {};
}

// Formats of Vulkan with red first and 8 bits a channel.
struct PlainFormat {
  uint32_t format;
  int channels;
  Transfer transfer;
};
constexpr PlainFormat plain_formats[] = {
    {9, 1, Transfer::linear},  {15, 1, Transfer::srgb}, {16, 2, Transfer::linear}, {22, 2, Transfer::srgb},
    {23, 3, Transfer::linear}, {29, 3, Transfer::srgb}, {37, 4, Transfer::linear}, {43, 4, Transfer::srgb}};

OrDamage<Ktx2File> read_ktx2_head(Bytes bytes) {
  constexpr size_t head = 80, level_bytes = 24;
  if (bytes.size() < head) return damage("the file is truncated");
  const auto word = [&](size_t index) { return little_endian<uint32_t>(bytes, 12 + 4 * index); };
  Ktx2File file{.width = word(2), .height = word(3), .levels = std::max(word(7), 1u), .packing = Packing(word(8))};
  if (word(0) != 0) {
    const auto plain = std::ranges::find(plain_formats, word(0), &PlainFormat::format);
    if (plain == std::end(plain_formats))
      return damage(
          "its texels are of Vulkan's format {}; Basis Universal's (ETC1S, UASTC) and red, green, blue, alpha of 8 "
          "bits "
          "each are read",
          word(0));
    file.plain_channels = plain->channels, file.transfer = plain->transfer;
  }
  constexpr uint32_t largest = 1 << 24;
  if (file.width == 0 || file.width > largest || file.height > largest) return damage("its size is out of range");
  if (file.height == 0 || word(4) != 0 || word(5) > 1 || word(6) != 1)
    return damage("it is no flat image but has {} rows, {} depth, {} layers, {} faces", word(3), word(4), word(5),
                  word(6));
  constexpr uint32_t most_levels = 32;
  if (file.levels > most_levels) return damage("it has {} levels", file.levels);
  const auto format = part_of(bytes, word(9), word(10)), notes = part_of(bytes, word(11), word(12));
  const auto global = part_of(bytes, little_endian<uint64_t>(bytes, 64), little_endian<uint64_t>(bytes, 72));
  if (bytes.size() < head + file.levels * level_bytes || !format || !notes || !global)
    return damage("the file is truncated");
  for (uint32_t i = file.levels; i-- > 0;) {
    const size_t at = head + i * level_bytes;
    const auto level = part_of(bytes, little_endian<uint64_t>(bytes, at), little_endian<uint64_t>(bytes, at + 8));
    if (!level) return damage("the file is truncated");
    file.level = *level;
  }
  file.global = *global;
  if (file.plain_channels == 0)
    if (std::string wrong = read_texel_format(*format, file); !wrong.empty()) return std::unexpected(wrong);
  if (std::string wrong = check_notes(*notes); !wrong.empty()) return std::unexpected(wrong);
  if (file.packing > Packing::zlib)
    return damage("it is packed by scheme {}; none, BasisLZ, Zstandard and zlib are read", word(8));
  if (file.plain_channels > 0) {
    if (file.packing == Packing::basis_lz) return damage("plain texels packed by scheme 1 are not read");
    return file;
  }
  if (file.uastc == (file.packing == Packing::basis_lz))
    return damage("{} texels packed by scheme {} are not read", file.uastc ? "UASTC" : "ETC1S", word(8));
  return file;
}

// Level 0, which has `wanted` bytes; `unpacked` keeps those that were packed.
OrDamage<Bytes> level_bytes(const Ktx2File& file, uint64_t wanted, std::vector<std::byte>& unpacked) {
  if (file.packing == Packing::none) {
    if (file.level.size() < wanted) return damage("the file is truncated");
    return file.level.first(size_t(wanted));
  }
  // Only the size that the picture has is unpacked, whatever the stream says.
  unpacked.resize(size_t(wanted));
  size_t got = 0;
  bool good = false;
  if (file.packing == Packing::zstandard) {
    got = ZSTD_decompress(unpacked.data(), unpacked.size(), file.level.data(), file.level.size());
    good = !ZSTD_isError(got);
  } else {
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
    if (!inflate) throw std::bad_alloc();
    good = libdeflate_zlib_decompress(inflate.get(), file.level.data(), file.level.size(), unpacked.data(),
                                      unpacked.size(), &got) == LIBDEFLATE_SUCCESS;
  }
  if (!good || got != wanted)
    return damage("its {} stream does not unpack to {} bytes",
                  file.packing == Packing::zstandard ? "Zstandard" : "zlib", wanted);
  return Bytes(unpacked);
}

std::string decode_uastc_image(const Ktx2File& file, DecodedImage& image) {
  std::vector<std::byte> unpacked;
  const OrDamage<Bytes> blocks = level_bytes(file, file.blocks() * 16, unpacked);
  if (!blocks) return blocks.error();
  const uint32_t columns = (file.width + 3) / 4;
  UastcTexels texels;
  for (size_t block = 0; block < file.blocks(); ++block) {
    if (!decode_uastc(blocks->subspan(block * 16).first<16>(), texels))
      return fmt::format("block {} is of a mode or partition that UASTC does not have", block);
    const auto x = uint32_t(block % columns) * 4, y = uint32_t(block / columns) * 4;
    for (uint32_t v = 0; v < std::min(4u, file.height - y); ++v)
      std::memcpy(&image.pixels[(size_t(y + v) * file.width + x) * 4], &texels[v * 4],
                  4 * size_t(std::min(4u, file.width - x)));
  }
  using enum Channel8;
  const bool alpha = file.channels[0] == uastc_rgba, green = file.channels[0] == uastc_red_alpha;
  if (!alpha)
    for (size_t i = 0; i < image.pixels.size(); i += 4) {
      if (green) image.pixels[i + 1] = image.pixels[i + 3];
      image.pixels[i + 3] = std::byte(255);
    }
  return {};
}

// Channels that the file lacks are 0, alpha 1, as Vulkan samples them.
std::string decode_plain_image(const Ktx2File& file, DecodedImage& image) {
  const auto channels = size_t(file.plain_channels);
  std::vector<std::byte> unpacked;
  const OrDamage<Bytes> texels = level_bytes(file, uint64_t(file.width) * file.height * channels, unpacked);
  if (!texels) return texels.error();
  for (size_t i = 0; i < image.pixels.size() / 4; ++i)
    for (size_t c = 0; c < 4; ++c)
      image.pixels[4 * i + c] = c < channels ? (*texels)[i * channels + c] : c == 3 ? std::byte(255) : std::byte(0);
  return {};
}

std::string decode_etc1s_image(const Ktx2File& file, DecodedImage& image) {
  constexpr size_t head = 20, description = 20;
  const uint64_t slices_at = head + uint64_t(file.levels) * description;
  if (file.global.size() < slices_at) return "its codebooks are truncated";
  const auto word = [&](size_t at) { return little_endian<uint32_t>(file.global, at); };
  auto section = [&, at = slices_at](uint32_t length) mutable {
    const auto part = part_of(file.global, at, length);
    at += length;
    return part;
  };
  const auto colours = section(word(4)), patterns = section(word(8)), codes = section(word(12));
  if (!colours || !patterns || !codes) return "its codebooks are truncated";
  const auto decoder = Etc1sDecoder::make({.colour_count = little_endian<uint16_t>(file.global, 0),
                                           .pattern_count = little_endian<uint16_t>(file.global, 2),
                                           .colours = *colours,
                                           .patterns = *patterns,
                                           .codes = *codes});
  if (!decoder) return decoder.error();
  if (word(head) & 2) return "its image is a difference to another";
  for (uint32_t i = 0; i < file.slices; ++i) {
    const auto stream = part_of(file.level, word(head + 4 + 8 * i), word(head + 8 + 8 * i));
    if (!stream || stream->empty()) return "a slice is truncated";
    const auto texels = decoder->slice(*stream, file.width, file.height);
    if (!texels) return texels.error();
    // The second slice is alpha or green, in all of its channels; decoders take its green.
    const bool second = i == 1;
    const size_t into = file.channels[1] == Channel8::etc1s_alpha ? 3 : 1;
    for (size_t t = 0; t < texels->size(); ++t) {
      std::byte* const texel = &image.pixels[t * 4];
      if (second)
        texel[into] = std::byte((*texels)[t][1]);
      else
        for (size_t c = 0; c < 4; ++c) texel[c] = c < 3 ? std::byte((*texels)[t][c]) : std::byte(255);
    }
  }
  return {};
}

}  // namespace

bool is_ktx2(Bytes bytes) {
  return bytes.size() >= ktx2_start.size() && std::memcmp(bytes.data(), ktx2_start.data(), ktx2_start.size()) == 0;
}

Expected<ImageInfo> probe_ktx2(Bytes bytes, const std::string& place) {
  const auto file = read_ktx2_head(bytes);
  if (!file) return fail(ErrorKind::input, place, "the KTX2 image cannot be read: {}", file.error());
  return ImageInfo{int(file->width), int(file->height), file->source_channels(), 8, file->transfer};
}

Expected<DecodedImage> decode_ktx2(Bytes bytes, const std::string& place) {
  const auto file = read_ktx2_head(bytes);
  DecodedImage image;
  std::string wrong = file ? "" : file.error();
  if (file) {
    image = {int(file->width), int(file->height), DecodedImage::Format::rgba8, file->source_channels(), {}};
    image.pixels.resize(size_t(file->width) * file->height * 4);
    wrong = file->plain_channels > 0 ? decode_plain_image(*file, image)
            : file->uastc            ? decode_uastc_image(*file, image)
                                     : decode_etc1s_image(*file, image);
  }
  if (!wrong.empty()) return fail(ErrorKind::input, place, "the KTX2 image cannot be read: {}", wrong);
  return image;
}

}  // namespace candela
