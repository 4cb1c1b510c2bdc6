// Radiance HDR: a text head, then pixels of three 8-bit mantissas with one shared exponent, flat or run-length encoded
// by scan line (Greg Ward, "Real Pixels", Graphics Gems II, 1991). stb's decoder neither sees truncation nor turned
// images.
#include "image/hdr.h"

#include <charconv>
#include <cstring>

#include "image/exr.h"
#include "image/sky_rows.h"

namespace candela {
namespace {

struct Head {
  int width = 0, height = 0;
  bool from_bottom = false, from_right = false;
  float exposure = 1;  // the pixels were multiplied by it
  size_t pixels_at = 0;
};

std::string_view next_line(std::string_view text, size_t& at) {
  const size_t end = text.find('\n', at);
  if (end == std::string_view::npos) {
    at = text.size() + 1;
    return {};
  }
  std::string_view line = text.substr(at, end - at);
  at = end + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// "-Y 512 +X 1024": rows from the top, columns from the left. Turned images (X first) are not used by anyone.
bool parse_resolution(std::string_view line, Head& head) {
  std::array<std::string_view, 4> words;
  size_t count = 0;
  for (size_t i = 0; i < line.size();) {
    if (line[i] == ' ') {
      ++i;
      continue;
    }
    const size_t end = std::min(line.find(' ', i), line.size());
    if (count == 4) return false;
    words[count++] = line.substr(i, end - i);
    i = end;
  }
  if (count != 4) return false;
  const auto number = [](std::string_view word, int& value) {
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    return result.ec == std::errc() && result.ptr == word.data() + word.size() && value > 0;
  };
  if ((words[0] != "-Y" && words[0] != "+Y") || (words[2] != "+X" && words[2] != "-X")) return false;
  head.from_bottom = words[0] == "+Y";
  head.from_right = words[2] == "-X";
  return number(words[1], head.height) && number(words[3], head.width);
}

Expected<Head> parse_head(std::span<const std::byte> bytes, const std::string& place) {
  if (!is_hdr(bytes)) return fail(ErrorKind::input, place, "is not a Radiance HDR image");
  // The head is text of a few lines; a bound keeps a file of newlines from being scanned for nothing.
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<size_t>(bytes.size(), 65536));
  Head head;
  size_t at = 0;
  next_line(text, at);
  for (;;) {
    if (at >= text.size()) return fail(ErrorKind::input, place, "the head of the Radiance HDR image does not end");
    const std::string_view line = next_line(text, at);
    if (line.empty()) break;
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      return fail(ErrorKind::input, place, "the Radiance HDR format \"{}\" is not supported; only 32-bit_rle_rgbe is",
                  line.substr(7));
    if (line.starts_with("EXPOSURE=")) {
      std::string_view value = line.substr(9);
      while (value.starts_with(' ')) value.remove_prefix(1);
      float factor = 0;
      if (std::from_chars(value.data(), value.data() + value.size(), factor).ec == std::errc() && factor > 0 &&
          std::isfinite(factor))
        head.exposure *= factor;
    }
  }
  if (at >= text.size() || !parse_resolution(next_line(text, at), head))
    return fail(ErrorKind::input, place, "the Radiance HDR image has no size line of the form \"-Y height +X width\"");
  head.pixels_at = std::min(at, text.size());
  return head;
}

// One scan line of 4-byte pixels; false when the data ends early or a run is longer than the line.
class LineReader {
 public:
  LineReader(std::span<const std::byte> data, int width) : data_(data), width_(size_t(width)) {}

  size_t consumed() const { return at_; }
  bool read(std::span<uint8_t> line) {
    if (width_ >= 8 && width_ < 32768 && left() >= 4 && byte(0) == 2 && byte(1) == 2 && byte(2) < 128) {
      if (size_t(byte(2)) << 8 != (width_ & 0x7f00) || byte(3) != (width_ & 0xff)) return false;
      at_ += 4;
      for (int component = 0; component < 4; ++component)
        if (!read_runs(line, component)) return false;
      return true;
    }
    return read_flat(line);
  }

 private:
  size_t left() const { return data_.size() - at_; }
  uint8_t byte(size_t offset) const { return uint8_t(data_[at_ + offset]); }

  bool read_runs(std::span<uint8_t> line, int component) {
    for (size_t x = 0; x < width_;) {
      if (left() < 2) return false;
      const bool repeats = byte(0) > 128;
      const size_t count = repeats ? byte(0) - 128u : byte(0);
      if (count == 0 || count > width_ - x || left() < 1 + (repeats ? 1 : count)) return false;
      for (size_t i = 0; i < count; ++i) line[(x + i) * 4 + component] = byte(1 + (repeats ? 0 : i));
      at_ += 1 + (repeats ? 1 : count);
      x += count;
    }
    return true;
  }

  // The format of 1985: plain pixels, where (1,1,1,n) repeats the last one n times, shifted by 8 for each repeat in a
  // row.
  bool read_flat(std::span<uint8_t> line) {
    int shift = 0;
    for (size_t x = 0; x < width_;) {
      if (left() < 4) return false;
      if (byte(0) == 1 && byte(1) == 1 && byte(2) == 1) {
        const uint64_t count = uint64_t(byte(3)) << shift;
        if (x == 0 || count > width_ - x) return false;
        for (uint64_t i = 0; i < count; ++i, ++x) std::memcpy(&line[x * 4], &line[(x - 1) * 4], 4);
        shift = std::min(shift + 8, 24);
      } else {
        std::memcpy(&line[x * 4], data_.data() + at_, 4);
        ++x;
        shift = 0;
      }
      at_ += 4;
    }
    return true;
  }

  std::span<const std::byte> data_;
  size_t width_, at_ = 0;
};

}  // namespace

bool is_hdr(std::span<const std::byte> bytes) {
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()), std::min<size_t>(bytes.size(), 11));
  return start.starts_with("#?RADIANCE") || start.starts_with("#?RGBE");
}

Expected<ImageInfo> probe_hdr(std::span<const std::byte> bytes, const std::string& place) {
  auto head = parse_head(bytes, place);
  if (!head) return std::unexpected(head.error());
  return ImageInfo{head->width, head->height, 3, 32};
}

namespace {
// Run lengths hold at most 127 pixels in 8 bytes, so 16 pixels a byte is the rule for sizes out of proportion. (The
// repeats of 1985 could hold more in a picture of a single colour.)
Expected<void> check_size(const Head& head, uint64_t file_bytes, int max_side, const std::string& place) {
  if (head.width > max_side || head.height > max_side)
    return fail(ErrorKind::input, place, "{}x{} pixels are more than {} on a side", head.width, head.height, max_side);
  if (uint64_t(head.width) * uint64_t(head.height) / 16 > file_bytes - head.pixels_at)
    return fail(ErrorKind::input, place, "{}x{} pixels cannot be held by {} bytes: the file is truncated", head.width,
                head.height, file_bytes);
  return {};
}

// Of each shared exponent.
std::array<float, 256> scales_of(const Head& head) {
  std::array<float, 256> scales{};
  for (int e = 1; e < 256; ++e) scales[size_t(e)] = std::ldexp(1.0f, e - 136) / head.exposure;
  return scales;
}
void decode_line(const Head& head, const std::array<float, 256>& scales, const uint8_t* line, float* target) {
  for (int x = 0; x < head.width; ++x) {
    const uint8_t* p = line + size_t(head.from_right ? head.width - 1 - x : x) * 4;
    for (int c = 0; c < 3; ++c) target[x * 4 + c] = float(p[c]) * scales[p[3]];
    target[x * 4 + 3] = 1.0f;
  }
}
}  // namespace

Expected<DecodedImage> decode_hdr(std::span<const std::byte> bytes, const std::string& place, int max_side) {
  auto head = parse_head(bytes, place);
  if (!head) return std::unexpected(head.error());
  if (auto fits = check_size(*head, bytes.size(), max_side, place); !fits) return std::unexpected(fits.error());
  const int width = head->width, height = head->height;
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  image.pixels.resize(size_t(width) * size_t(height) * 16);
  auto* out = reinterpret_cast<float*>(image.pixels.data());
  const auto scales = scales_of(*head);
  std::vector<uint8_t> line(size_t(width) * 4);
  LineReader reader(bytes.subspan(head->pixels_at), width);
  for (int row = 0; row < height; ++row) {
    if (!reader.read(line)) return fail(ErrorKind::input, place, "line {} of {} is truncated or damaged", row, height);
    decode_line(*head, scales, line.data(),
                out + size_t(head->from_bottom ? height - 1 - row : row) * size_t(width) * 4);
  }
  return image;
}

Expected<void> read_hdr_rows(const FileReader& file, const std::string& place, SkyRowSink& sink) {
  std::vector<std::byte> window(std::min<uint64_t>(file.size(), 65536));
  window.resize(file.read_at(0, window));
  auto head = parse_head(window, place);
  if (!head) return std::unexpected(head.error());
  if (auto fits = check_size(*head, file.size(), max_exr_side, place); !fits) return fits;
  const int width = head->width, height = head->height;
  if (auto fits = sink.begin({width, height, 3, 32}); !fits) return fits;
  const auto scales = scales_of(*head);
  // The longest line has a count for each byte of each pixel.
  const size_t longest = size_t(width) * 8 + 4;
  constexpr size_t ahead = size_t(8) << 20;
  uint64_t at = head->pixels_at;  // in the file, of the window's first byte
  size_t used = 0;
  window.clear();
  const int strip = std::min(256, height);
  std::vector<uint8_t> lines(size_t(strip) * size_t(width) * 4);
  for (int first = 0; first < height; first += strip) {
    const int count = std::min(strip, height - first);
    for (int i = 0; i < count; ++i) {
      if (window.size() - used < longest && at + window.size() < file.size()) {
        at += used, used = 0;
        window.resize(std::min<uint64_t>(file.size() - at, ahead + longest));
        window.resize(file.read_at(at, window));
      }
      LineReader reader(std::span<const std::byte>(window).subspan(used), width);
      if (!reader.read(std::span(lines).subspan(size_t(i) * size_t(width) * 4, size_t(width) * 4)))
        return fail(ErrorKind::input, place, "line {} of {} is truncated or damaged", first + i, height);
      used += reader.consumed();
    }
    const int top = head->from_bottom ? height - first - count : first;
    sink.add(top, count, [&](int row, float* texels) {
      const int line = head->from_bottom ? count - 1 - (row - top) : row - top;
      decode_line(*head, scales, lines.data() + size_t(line) * size_t(width) * 4, texels);
    });
  }
  return {};
}

}  // namespace candela
