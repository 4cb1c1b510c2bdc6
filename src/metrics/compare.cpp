#include "metrics/compare.h"

#include <bit>
#include <set>

#include "image/io.h"
#include "metrics/flip.h"
#include "metrics/planes.h"
#include "metrics/ssim.h"

namespace candela {
namespace {

std::string names_of(const FloatImage& image) {
  std::set<std::string> sorted;
  for (const Channel& channel : image.channels) sorted.insert(channel.name);
  std::string text;
  for (const std::string& name : sorted) text += (text.empty() ? "" : " ") + name;
  return text;
}

// NaN matches any NaN, an infinity the same infinity, a number any number.
bool same_finiteness(float a, float b) {
  if (std::isfinite(a) && std::isfinite(b)) return true;
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return a == b;
}

// Every comparison with NaN is false, so "difference > limit" lets a broken image pass: finiteness is asked first.
std::string finiteness_refusal(const FloatImage& reference, const FloatImage& test, size_t& in_both) {
  size_t mismatches = 0;
  std::string first;
  const size_t width = size_t(reference.width);
  for (size_t i = 0; i < width * size_t(reference.height); ++i) {
    bool mismatch = false;
    for (const Channel& a : reference.channels) {
      if (a.type == ChannelType::uint32) continue;
      const Channel& b = *test.find(a.name);
      const float va = a.f[i], vb = b.f[i];
      if (same_finiteness(va, vb)) {
        in_both += !std::isfinite(va);
        continue;
      }
      if (mismatches == 0 && !mismatch)
        first = fmt::format("channel {} of pixel ({}, {}) is {} in the reference and {} in the test image", a.name,
                            i % width, i / width, va, vb);
      mismatch = true;
    }
    mismatches += mismatch;
  }
  if (mismatches == 0) return {};
  return fmt::format("{} pixels are finite in one image only; the first: {}", mismatches, first);
}

std::string refusal_of(const FloatImage& a, const FloatImage& b, size_t& nonfinite_in_both) {
  if (a.width != b.width || a.height != b.height)
    return fmt::format("the sizes differ: {}x{} and {}x{}", a.width, a.height, b.width, b.height);
  if (a.width <= 0 || a.height <= 0) return "the images have no pixels";
  if (a.origin_x != b.origin_x || a.origin_y != b.origin_y || a.display_width != b.display_width ||
      a.display_height != b.display_height)
    return fmt::format(
        "the windows differ: data at ({}, {}) and ({}, {}) of displays of {}x{} and {}x{} (0x0: the data window)",
        a.origin_x, a.origin_y, b.origin_x, b.origin_y, a.display_width, a.display_height, b.display_width,
        b.display_height);
  if (names_of(a) != names_of(b))
    return fmt::format("the channels differ: \"{}\" and \"{}\"", names_of(a), names_of(b));
  for (const Channel& channel : a.channels)
    if ((channel.type == ChannelType::uint32) != (b.find(channel.name)->type == ChannelType::uint32))
      return fmt::format("channel {} holds integers in one image only", channel.name);
  return finiteness_refusal(a, b, nonfinite_in_both);
}

// The channels that max, mae, rmse and relmse run over (see compare.h).
std::vector<std::pair<const Channel*, const Channel*>> numeric_channels(const FloatImage& a, const FloatImage& b) {
  std::vector<std::pair<const Channel*, const Channel*>> plain, layered;
  for (const Channel& channel : a.channels) {
    if (channel.type == ChannelType::uint32) continue;
    (channel.name.find('.') == std::string::npos ? plain : layered).emplace_back(&channel, b.find(channel.name));
  }
  return plain.empty() ? layered : plain;
}

void add_numeric_metrics(const FloatImage& a, const FloatImage& b, std::map<std::string, double>& metrics) {
  const auto channels = numeric_channels(a, b);
  if (channels.empty()) return;
  struct Row {
    double largest = 0, absolute = 0, square = 0, relative = 0;
  };
  std::vector<Row> rows(static_cast<size_t>(a.height));
  const size_t width = size_t(a.width);
  sum_rows(a.height, [&](int y) {
    Row row;
    for (const auto& [from, to] : channels)
      for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i) {
        if (!std::isfinite(from->f[i])) continue;  // equal in both, or it would have been refused
        const double r = from->f[i], d = std::abs(double(to->f[i]) - r);
        row.largest = std::max(row.largest, d);
        row.absolute += d;
        row.square += d * d;
        row.relative += d * d / (r * r + 0.01);
      }
    rows[size_t(y)] = row;
    return 0.0;
  });
  Row all;
  for (const Row& row : rows) {
    all.largest = std::max(all.largest, row.largest);
    all.absolute += row.absolute, all.square += row.square, all.relative += row.relative;
  }
  const double count = double(channels.size()) * double(width) * double(a.height);
  metrics["max"] = all.largest;
  metrics["mae"] = all.absolute / count;
  metrics["rmse"] = std::sqrt(all.square / count);
  metrics["relmse"] = all.relative / count;
}

double differing_pixels(const FloatImage& a, const FloatImage& b) {
  std::vector<std::pair<const Channel*, const Channel*>> channels;
  for (const Channel& channel : a.channels) channels.emplace_back(&channel, b.find(channel.name));
  const size_t width = size_t(a.width);
  return sum_rows(a.height, [&](int y) {
    size_t count = 0;
    for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i)
      count += std::any_of(channels.begin(), channels.end(), [&](const auto& pair) {
        if (pair.first->type == ChannelType::uint32) return pair.first->u[i] != pair.second->u[i];
        return std::bit_cast<uint32_t>(pair.first->f[i]) != std::bit_cast<uint32_t>(pair.second->f[i]);
      });
    return double(count);
  });
}

double psnr(const std::vector<Plane>& a, const std::vector<Plane>& b, int width, int height) {
  const double sum = sum_rows(height, [&](int y) {
    double of_row = 0;
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = size_t(y) * size_t(width); i < size_t(y + 1) * size_t(width); ++i) {
        const double d = double(a[c][i]) - double(b[c][i]);
        of_row += d * d;
      }
    return of_row;
  });
  const double mse = sum / (3.0 * double(width) * double(height));
  return mse == 0 ? psnr_of_equal : std::min(psnr_of_equal, -10 * std::log10(mse));
}

float srgb_from_linear(float v) { return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

}  // namespace

std::vector<std::vector<float>> display_planes(const FloatImage& image, Encoding encoding) {
  std::array<const Channel*, 3> colour = {image.find("R"), image.find("G"), image.find("B")};
  if (const Channel* grey = image.find("Y"); grey && !colour[0]) colour = {grey, grey, grey};
  std::vector<std::vector<float>> planes;
  for (const Channel* channel : colour) {
    if (!channel || channel->type == ChannelType::uint32) return {};
    std::vector<float>& plane = planes.emplace_back(channel->f);
    for (float& v : plane) {
      v = v > 0 ? std::min(v, 1.0f) : 0.0f;  // NaN becomes 0
      if (encoding == Encoding::linear) v = srgb_from_linear(v);
    }
  }
  return planes;
}

Comparison compare(const FloatImage& reference, const FloatImage& test, const CompareOptions& options) {
  Comparison result{.width = reference.width, .height = reference.height};
  result.refusal = refusal_of(reference, test, result.nonfinite_in_both);
  if (!result.refusal.empty()) return result;
  add_numeric_metrics(reference, test, result.metrics);
  result.metrics["differing"] = differing_pixels(reference, test);
  const auto a = display_planes(reference, options.encoding), b = display_planes(test, options.encoding);
  if (a.empty()) return result;
  result.metrics["psnr"] = psnr(a, b, result.width, result.height);
  if (!options.perceptual) return result;
  result.metrics["ssim"] = ssim(a, b, result.width, result.height);
  result.flip_map = flip_map(a, b, result.width, result.height);
  result.metrics["flip"] = flip_mean(result.flip_map, result.width, result.height);
  return result;
}

namespace {

// What the reference tracer says of its own noise is no part of the picture, where the other file does not say the like.
void set_variance_aside(FloatImage& a, const FloatImage& b) {
  std::erase_if(a.channels, [&](const Channel& c) { return c.name.starts_with("variance.") && !b.find(c.name); });
}

}  // namespace

Expected<Comparison> compare_files(const std::filesystem::path& reference, const std::filesystem::path& test,
                                   bool perceptual) {
  const auto encoding = [](const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return ending == ".exr" || ending == ".hdr" ? Encoding::linear : Encoding::display;
  };
  auto a = read_image(reference);
  if (!a) return std::unexpected(a.error());
  auto b = read_image(test);
  if (!b) return std::unexpected(b.error());
  set_variance_aside(*a, *b);
  set_variance_aside(*b, *a);
  if (encoding(reference) != encoding(test))
    return Comparison{.refusal = "one file is scene-linear, the other display-encoded: no metric has a meaning",
                      .width = a->width,
                      .height = a->height};
  return compare(*a, *b, {encoding(reference), perceptual});
}

bool is_blank(const FloatImage& image) {
  for (const char* name : {"R", "G", "B", "Y"}) {
    const Channel* channel = image.find(name);
    if (!channel || channel->f.empty()) continue;
    const auto bits = [](float v) { return std::bit_cast<uint32_t>(v); };
    if (std::any_of(channel->f.begin(), channel->f.end(), [&](float v) { return bits(v) != bits(channel->f[0]); }))
      return false;
  }
  return true;
}

}  // namespace candela
