#include "bench/picture.h"

#include <bit>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/statistics.h"
#include "image/half.h"
#include "image/png_write.h"
#include "job/frame_choices.h"

namespace candela {
namespace {

float channel(const Beauty& image, size_t pixel, size_t c) {
  const std::byte* at = image.bytes.data() + pixel * image.pixel_bytes;
  if (image.pixel_bytes == 16) {
    float value;
    std::memcpy(&value, at + c * 4, 4);
    return value;
  }
  uint16_t value;
  std::memcpy(&value, at + c * 2, 2);
  return half_to_float(value);
}

double distance(float a, float b) {
  if (std::isfinite(a) && std::isfinite(b)) return std::abs(double(a) - double(b));
  const bool same = std::isnan(a) ? std::isnan(b) : a == b;
  return same ? 0 : std::numeric_limits<double>::infinity();
}

const FrameOutput* output_of(const FrameResult& frame, const std::string& layer) {
  for (const FrameOutput& output : frame.outputs)
    if (output.layer == layer && frame.readbacks.contains(output.resource)) return &output;
  return nullptr;
}

std::span<const std::byte> bytes_of(const FrameResult& frame, const FrameOutput& output) {
  const size_t size = size_t(frame.width_px) * size_t(frame.height_px) * format_bytes(output.format);
  const std::span<const std::byte> bytes = frame.readbacks.at(output.resource)->bytes();
  CHECK_MSG(bytes.size() >= size, output.layer);
  return bytes.first(size);
}

// The colour map viridis (Smith, van der Walt, 2015) at ten places, linear between them.
std::array<float, 3> viridis(float t) {
  static constexpr float colors[10][3] = {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},  {49, 104, 142},
                                          {38, 130, 142}, {31, 158, 137}, {53, 183, 121}, {109, 205, 89},
                                          {180, 222, 44}, {253, 231, 37}};
  const float at = std::clamp(t, 0.0f, 1.0f) * 9;
  const size_t below = std::min(size_t(at), size_t(8));
  std::array<float, 3> rgb{};
  for (size_t k = 0; k < 3; ++k) rgb[k] = std::lerp(colors[below][k], colors[below + 1][k], at - float(below));
  return rgb;
}

std::vector<std::byte> encoded(const DisplayImage& image) {
  auto png = encode_png(image, "thumbnail");
  return png ? std::move(*png) : std::vector<std::byte>{};
}

}  // namespace

std::optional<Beauty> beauty_of(const FrameResult& frame) {
  const FrameOutput* output = output_of(frame, "beauty");
  if (!output) return std::nullopt;
  CHECK(output->format == VK_FORMAT_R32G32B32A32_SFLOAT || output->format == VK_FORMAT_R16G16B16A16_SFLOAT);
  const auto bytes = bytes_of(frame, *output);
  return Beauty{frame.width_px, frame.height_px, format_bytes(output->format), {bytes.begin(), bytes.end()}};
}

PictureDifference difference(const Beauty& reference, const Beauty& test) {
  CHECK(reference.width_px == test.width_px && reference.height_px == test.height_px &&
        reference.pixel_bytes == test.pixel_bytes);
  PictureDifference result;
  const size_t pixels = reference.bytes.size() / reference.pixel_bytes;
  for (size_t i = 0; i < pixels; ++i) {
    const size_t at = i * reference.pixel_bytes;
    if (std::memcmp(reference.bytes.data() + at, test.bytes.data() + at, reference.pixel_bytes) == 0) continue;
    if (result.differing++ == 0) {
      result.first_x = int(i % size_t(reference.width_px));
      result.first_y = int(i / size_t(reference.width_px));
    }
    for (size_t c = 0; c < 4; ++c)
      result.max_difference = std::max(result.max_difference, distance(channel(reference, i, c), channel(test, i, c)));
  }
  return result;
}

std::vector<std::string> light_list_layers() {
  std::vector<std::string> layers;
  const std::vector<std::string> known = layer_names();
  for (const char* layer : {listed_layer, wasted_layer, missed_layer})
    if (std::find(known.begin(), known.end(), layer) != known.end()) layers.emplace_back(layer);
  return layers;
}

std::vector<float> layer_values(const FrameResult& frame, const std::string& layer) {
  const FrameOutput* output = output_of(frame, layer);
  if (!output || output->format != VK_FORMAT_R32_SFLOAT) return {};
  const auto bytes = bytes_of(frame, *output);
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::optional<LightLists> light_lists(const FrameResult& frame) {
  const std::vector<float> listed = layer_values(frame, listed_layer);
  if (listed.empty()) return std::nullopt;
  const auto sum = [](const std::vector<float>& values) {
    double total = 0;
    for (const float v : values) total += v;
    return total;
  };
  const double total = sum(listed);
  LightLists lists;
  lists.mean = total / double(listed.size());
  lists.p95 = percentile(std::vector<double>(listed.begin(), listed.end()), 0.95);
  lists.max = *std::max_element(listed.begin(), listed.end());
  lists.waste_fraction = total > 0 ? sum(layer_values(frame, wasted_layer)) / total : 0;
  lists.missed = sum(layer_values(frame, missed_layer));
  return lists;
}

std::vector<std::byte> thumbnail_png(const DisplayImage& image, int most_px) {
  if (image.bits != 8 || image.width < 1 || image.height < 1) return {};
  const int step = std::max(1, (std::max(image.width, image.height) + most_px - 1) / most_px);
  DisplayImage small{(image.width + step - 1) / step, (image.height + step - 1) / step, 3, 8, {}};
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      for (int c = 0; c < 3; ++c) {
        // The mean of code values: a thumbnail need not be photometric.
        unsigned sum = 0, count = 0;
        for (int v = y * step; v < std::min((y + 1) * step, image.height); ++v)
          for (int u = x * step; u < std::min((x + 1) * step, image.width); ++u, ++count)
            sum += unsigned(
                image.pixels[(size_t(v) * size_t(image.width) + size_t(u)) * size_t(image.channels) + size_t(c)]);
        small.pixels.push_back(std::byte((sum + count / 2) / count));
      }
  return encoded(small);
}

std::vector<std::byte> heatmap_png(const std::vector<float>& values, int width_px, int height_px, int most_px) {
  if (values.empty()) return {};
  // The 95th percentile (LightLists::p95) and all beyond are yellow: a few long lists must not darken the rest.
  const float top = std::max(1.0f, float(percentile(std::vector<double>(values.begin(), values.end()), 0.95)));
  DisplayImage image{width_px, height_px, 3, 8, {}};
  image.pixels.reserve(values.size() * 3);
  for (const float value : values)
    for (const float c : viridis(value / top)) image.pixels.push_back(std::byte(uint8_t(std::lround(c))));
  return thumbnail_png(image, most_px);
}

}  // namespace candela
