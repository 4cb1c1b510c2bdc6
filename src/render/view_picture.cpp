#include "render/view_picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "metrics/heatmap.h"
#include "render/count_view.h"
#include "render/frame_layers.h"
#include "render/scale_bar.h"

namespace candela {
namespace {

using Rgb = std::array<uint8_t, 3>;
constexpr Rgb not_finite = {255, 0, 255};

uint8_t code_of(double value) { return uint8_t(std::lround(std::clamp(value, 0.0, 1.0) * 255)); }

double srgb_encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// Bright colours that differ where ids do, by the bits of a multiplicative hash (Knuth 1998, 6.4).
Rgb color_of_id(uint32_t id) {
  if (id == 0xffffffffu) return {};
  uint32_t bits = (id + 1) * 2654435761u;
  bits = (bits ^ bits >> 15) * 2246822519u;
  bits ^= bits >> 13;
  return {uint8_t(64 + (bits & 0xff) * 191 / 255), uint8_t(64 + (bits >> 8 & 0xff) * 191 / 255),
          uint8_t(64 + (bits >> 16 & 0xff) * 191 / 255)};
}

void set(DisplayImage& picture, size_t pixel, Rgb color) {
  for (size_t c = 0; c < 3; ++c) picture.pixels[pixel * 3 + c] = std::byte(color[c]);
}

DisplayImage blank(int width, int height) {
  DisplayImage picture{.width = width, .height = height};
  picture.pixels.resize(row_bytes(picture) * size_t(height));
  return picture;
}

// The channel of each primary; of an image with one channel that one.
std::array<const std::vector<float>*, 3> primaries(const FloatImage& image) {
  std::array<const std::vector<float>*, 3> found{};
  for (size_t c = 0; c < 3; ++c) found[c] = &image.channels[std::min(c, image.channels.size() - 1)].f;
  return found;
}

// Every pixel by what `code` makes of a channel's value.
template <class Code>
DisplayImage by_channel(const FloatImage& image, Code code) {
  DisplayImage picture = blank(image.width, image.height);
  const auto planes = primaries(image);
  for (size_t i = 0; i < planes[0]->size(); ++i) {
    Rgb color{};
    bool finite = true;
    for (size_t c = 0; c < 3; ++c) {
      const float value = (*planes[c])[i];
      finite = finite && std::isfinite(value);
      color[c] = code_of(code(double(value)));
    }
    set(picture, i, finite ? color : not_finite);
  }
  return picture;
}

DisplayImage directions(const FloatImage& image) {
  DisplayImage picture = by_channel(image, [](double v) { return 0.5 + 0.5 * v; });
  const auto planes = primaries(image);
  for (size_t i = 0; i < planes[0]->size(); ++i)
    if ((*planes[0])[i] == 0 && (*planes[1])[i] == 0 && (*planes[2])[i] == 0) set(picture, i, {});
  return picture;
}

DisplayImage ids(const FloatImage& image) {
  DisplayImage picture = blank(image.width, image.height);
  const std::vector<uint32_t>& values = image.channels.front().u;
  for (size_t i = 0; i < values.size(); ++i) set(picture, i, color_of_id(values[i]));
  return picture;
}

// Of the two largest ids of each pixel, by their coverage.
DisplayImage mattes(const FloatImage& image) {
  DisplayImage picture = blank(image.width, image.height);
  for (size_t i = 0; i < image.channels.front().f.size(); ++i) {
    std::array<double, 3> sum{};
    for (size_t rank = 0; rank < 2; ++rank) {
      const double coverage = double(image.channels[2 * rank + 1].f[i]);
      const Rgb color = color_of_id(std::bit_cast<uint32_t>(image.channels[2 * rank].f[i]));
      for (size_t c = 0; c < 3; ++c) sum[c] += coverage * double(color[c]) / 255;
    }
    set(picture, i, {code_of(sum[0]), code_of(sum[1]), code_of(sum[2])});
  }
  return picture;
}

DisplayImage motions(const FloatImage& image) {
  DisplayImage picture = blank(image.width, image.height);
  const std::vector<float>&x = image.channels[0].f, &y = image.channels[1].f;
  double farthest = 0;
  for (size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i]))
      farthest = std::max({farthest, std::abs(double(x[i])), std::abs(double(y[i]))});
  const auto code = [&](float v) { return code_of(0.5 + (farthest > 0 ? 0.5 * double(v) / farthest : 0)); };
  for (size_t i = 0; i < x.size(); ++i)
    set(picture, i, std::isfinite(x[i]) && std::isfinite(y[i]) ? Rgb{code(x[i]), code(y[i]), 128} : not_finite);
  return picture;
}

struct Range {
  float low = std::numeric_limits<float>::infinity(), high = -low;
};
// Of the finite values below `end`.
Range range_of(const std::vector<float>& values, float end) {
  Range range;
  for (const float v : values)
    if (std::isfinite(v) && v < end) range.low = std::min(range.low, v), range.high = std::max(range.high, v);
  if (range.low > range.high) range = {0, 0};
  return range;
}

// Values below `end` in the colour map, the others black. falling: the least is the brightest.
DisplayImage mapped(const std::vector<float>& values, int width, int height, Range range, float end, bool falling) {
  Plane plane(values.size());
  const double span = double(range.high) - double(range.low);
  for (size_t i = 0; i < values.size(); ++i) {
    const double along = span > 0 ? std::clamp((double(values[i]) - double(range.low)) / span, 0.0, 1.0) : 1;
    plane[i] = std::isfinite(values[i]) && values[i] < end ? float(falling && span > 0 ? 1 - along : along) : 0;
  }
  DisplayImage picture = heatmap(plane, width, height);
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      set(picture, i, not_finite);
    else if (!(values[i] < end))
      set(picture, i, {});
  }
  return picture;
}

ScaleBar bar_of(std::string title, Range range, bool falling) {
  const auto text = [](double value) { return fmt::format("{:.4g}", value); };
  const double middle = 0.5 * double(range.low) + 0.5 * double(range.high);
  return {std::move(title), text(double(range.low)), text(middle), text(double(range.high)), falling};
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

constexpr float no_end = std::numeric_limits<float>::infinity();

DisplayImage distances(const FloatImage& image) {
  const std::vector<float>& values = image.channels.front().f;
  const Range range = range_of(values, background_depth_m);
  // What is farther than floats tell from nothing is nothing.
  std::vector<float> shown = values;
  for (float& v : shown)
    if (v > background_depth_m) v = background_depth_m;
  DisplayImage picture = mapped(shown, image.width, image.height, range, background_depth_m, true);
  draw_scale_bar(picture, bar_of("METRES ALONG THE VIEW AXIS", range, true));
  return picture;
}

}  // namespace

DisplayImage layer_view(const FloatImage& layer, LayerForm form, const std::string& name) {
  CHECK_MSG(!layer.channels.empty(), name);
  switch (form) {
    case LayerForm::count:
      return count_view(layer.channels.front().f, layer.width, layer.height, count_title(name));
    case LayerForm::distance:
      return distances(layer);
    case LayerForm::direction:
      return directions(layer);
    case LayerForm::fraction:
      return by_channel(layer, [](double v) { return v; });
    case LayerForm::color:
      return by_channel(layer, srgb_encoded);
    case LayerForm::id:
      return ids(layer);
    case LayerForm::matte:
      return mattes(layer);
    case LayerForm::motion:
      return motions(layer);
    case LayerForm::light:
      break;
  }
  CHECK_MSG(false, name + " is light, which goes through a tone curve");
}

DisplayImage image_view(const FloatImage& image, int width, int height, const std::string& name) {
  CHECK_MSG(!image.channels.empty(), name);
  const bool whole_numbers = image.channels.front().type == ChannelType::uint32, one = image.channels.size() == 1;
  const Range range = one && !whole_numbers ? range_of(image.channels.front().f, no_end) : Range{};
  const DisplayImage all = whole_numbers ? ids(image)
                           : one ? mapped(image.channels.front().f, image.width, image.height, range, no_end, false)
                                 : by_channel(image, srgb_encoded);
  const double scale = std::min(double(width) / image.width, double(height) / image.height);
  const int fitted_width = std::clamp(int(std::lround(image.width * scale)), 1, width),
            fitted_height = std::clamp(int(std::lround(image.height * scale)), 1, height);
  const int left = (width - fitted_width) / 2, top = (height - fitted_height) / 2;
  DisplayImage picture = blank(width, height);
  for (int y = 0; y < fitted_height; ++y)
    for (int x = 0; x < fitted_width; ++x) {
      const size_t from_x = size_t(x) * size_t(image.width) / size_t(fitted_width),
                   from_y = size_t(y) * size_t(image.height) / size_t(fitted_height);
      std::copy_n(&all.pixels[(from_y * size_t(image.width) + from_x) * 3], 3,
                  &picture.pixels[(size_t(y + top) * size_t(width) + size_t(x + left)) * 3]);
    }
  if (one && !whole_numbers) draw_scale_bar(picture, bar_of(in_capitals(name), range, false));
  return picture;
}

}  // namespace candela
