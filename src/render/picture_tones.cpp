#include "render/picture_tones.h"

#include <cmath>
#include <cstring>

#include "passes/post/pack.h"
#include "render/frame_layers.h"

namespace candela {
namespace {

// Display codes in a read-back, or planes of halves or floats.
struct Pixels {
  const std::byte* bytes = nullptr;
  size_t row_bytes = 0, pixel_bytes = 0, sample_bytes = 1;
  bool alpha = false;
};

std::optional<Pixels> display_pixels(const FrameResult& frame) {
  for (const FrameOutput& output : frame.outputs) {
    if (output.layer != "display" || !frame.readbacks.contains(output.resource)) continue;
    Pixels p;
    p.sample_bytes = output.format == VK_FORMAT_R8G8B8A8_UNORM ? 1 : 2;
    const bool rgb = output.packing == Packing::rgb;
    p.pixel_bytes = p.sample_bytes * (rgb ? 3 : 4);
    p.row_bytes = layout_of(frame, output).row_bytes;
    p.bytes = readback_bytes(frame, output).data();
    p.alpha = !rgb && frame.request.display_alpha();
    return p;
  }
  return std::nullopt;
}

uint32_t code(const Pixels& p, const std::byte* pixel, int channel) {
  if (p.sample_bytes == 1) return uint32_t(pixel[channel]);
  uint16_t value;
  std::memcpy(&value, pixel + 2 * channel, 2);
  return value >> 8;
}

// Whether every value of red, green and blue is 0 or -0: of halves and floats all bits but the sign's.
bool planes_are_black(const FrameResult& frame, const FrameOutput& output) {
  const PackLayout layout = layout_of(frame, output);
  const std::byte* bytes = readback_bytes(frame, output).data();
  const size_t sample = output.packing == Packing::half_planes ? 2 : 4;
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < frame.height_px; ++y) {
      const std::byte* row = bytes + size_t(c) * layout.plane_bytes + size_t(y) * layout.row_bytes;
      for (size_t i = 0; i < size_t(frame.width_px) * sample; ++i) {
        const bool sign = i % sample == sample - 1;
        if ((row[i] & (sign ? std::byte{0x7f} : std::byte{0xff})) != std::byte{0}) return false;
      }
    }
  return true;
}

std::optional<PictureTones> linear_tones(const FrameResult& frame) {
  for (const FrameOutput& output : frame.outputs) {
    const bool planes = output.packing == Packing::half_planes || output.packing == Packing::float_planes;
    if (output.layer != "beauty" || !planes || !frame.readbacks.contains(output.resource)) continue;
    if (planes_are_black(frame, output)) return PictureTones{.is_black = true};
    return PictureTones{.seen = 1};
  }
  return std::nullopt;
}

}  // namespace

std::optional<PictureTones> tones_of(const FrameResult& frame, const Job& job) {
  if (job.view != "beauty" || !frame.request.view_is_light) return std::nullopt;
  const auto found = display_pixels(frame);
  if (!found) return linear_tones(frame);
  const Pixels& p = *found;
  const size_t width = size_t(frame.width_px), height = size_t(frame.height_px);
  const auto behind = frame.request.behind_rgb;
  const auto pixel_at = [&](size_t x, size_t y) { return p.bytes + y * p.row_bytes + x * p.pixel_bytes; };
  const auto covered = [&](const std::byte* pixel) {
    if (p.alpha) return code(p, pixel, 3) != 0;
    if (!behind) return true;
    for (int c = 0; c < 3; ++c)
      if (code(p, pixel, c) != (*behind >> (16 - 8 * c) & 255)) return true;
    return false;
  };
  bool is_black = !behind;
  for (size_t y = 0; y < height && is_black; ++y)
    for (size_t x = 0; x < width && is_black; ++x) {
      const std::byte* pixel = pixel_at(x, y);
      is_black = (code(p, pixel, 0) | code(p, pixel, 1) | code(p, pixel, 2)) == 0;
    }
  const size_t step = std::max<size_t>(1, size_t(std::sqrt(double(width * height) / 65536)));
  double count = 0, clipped = 0, seen = 0;
  for (size_t y = step / 2; y < height; y += step)
    for (size_t x = step / 2; x < width; x += step) {
      const std::byte* pixel = pixel_at(x, y);
      if (!covered(pixel)) continue;
      const uint32_t most = std::max({code(p, pixel, 0), code(p, pixel, 1), code(p, pixel, 2)});
      ++count, clipped += most >= 254, seen += most > 8;  // dither takes white one code down
    }
  if (count == 0) return is_black ? std::optional(PictureTones{.is_black = true}) : std::nullopt;
  return PictureTones{clipped / count, seen / count, is_black};
}

}  // namespace candela
