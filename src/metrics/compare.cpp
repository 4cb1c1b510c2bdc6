#include "metrics/compare.h"

#include <bit>
#include <set>

#include "image/io.h"
#include "metrics/flip.h"
#include "metrics/numeric.h"
#include "metrics/planes.h"
#include "metrics/ssim.h"

namespace candela {
namespace {

std::string names_of(const FloatImage& image, bool with_alpha = true) {
  std::set<std::string> sorted;
  // What the reference tracer says of its own noise is no part of the picture.
  for (const Channel& channel : image.channels)
    if (!channel.name.starts_with("variance.") && (with_alpha || channel.name != "A")) sorted.insert(channel.name);
  std::string text;
  for (const std::string& name : sorted) text += (text.empty() ? "" : " ") + name;
  return text;
}

// One image alone has alpha, which is 1 everywhere, and all else is in both.
bool opaque_alpha_alone(const FloatImage& a, const FloatImage& b) {
  if (bool(a.find("A")) == bool(b.find("A")) || names_of(a, false) != names_of(b, false)) return false;
  const Channel& alpha = *(a.find("A") ? a : b).find("A");
  return alpha.type != ChannelType::uint32 && std::ranges::all_of(alpha.f, [](float v) { return v == 1; });
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
      const Channel* b = test.find(a.name);
      if (!b) continue;  // variance, and alpha of one image alone
      const float va = a.f[i], vb = b->f[i];
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
    return fmt::format("the sizes differ: {}x{} and {}x{}; only pictures of one size can be compared", a.width,
                       a.height, b.width, b.height);
  if (a.width <= 0 || a.height <= 0) return "the images have no pixels";
  if (a.origin_x != b.origin_x || a.origin_y != b.origin_y || a.display_width != b.display_width ||
      a.display_height != b.display_height)
    return fmt::format(
        "the windows differ: data at ({}, {}) and ({}, {}) of displays of {}x{} and {}x{} (0x0: the data window)",
        a.origin_x, a.origin_y, b.origin_x, b.origin_y, a.display_width, a.display_height, b.display_width,
        b.display_height);
  if (names_of(a) != names_of(b) && !opaque_alpha_alone(a, b))
    return fmt::format("the channels differ: \"{}\" and \"{}\"{}", names_of(a), names_of(b),
                       names_of(a, false) == names_of(b, false) ? "; where alpha is not 1 everywhere it counts" : "");
  for (const Channel& channel : a.channels)
    if (const Channel* other = b.find(channel.name);
        other && (channel.type == ChannelType::uint32) != (other->type == ChannelType::uint32))
      return fmt::format("channel {} holds integers in one image only", channel.name);
  return finiteness_refusal(a, b, nonfinite_in_both);
}

// The channels that max, mae, rmse and relmse run over (see compare.h).
std::vector<ChannelPair> numeric_channels(const FloatImage& a, const FloatImage& b) {
  std::vector<ChannelPair> plain, layered;
  for (const Channel& channel : a.channels) {
    const Channel* other = b.find(channel.name);
    if (!other || channel.type == ChannelType::uint32 || channel.name.starts_with("variance.")) continue;
    (channel.name.find('.') == std::string::npos ? plain : layered).emplace_back(&channel, other);
  }
  return plain.empty() ? layered : plain;
}

std::vector<ChannelPair> all_channels(const FloatImage& a, const FloatImage& b) {
  std::vector<ChannelPair> pairs;
  for (const Channel& channel : a.channels)
    if (const Channel* other = b.find(channel.name)) pairs.emplace_back(&channel, other);
  return pairs;
}

size_t nonfinite_pixels(const FloatImage& image) {
  size_t count = 0;
  for (size_t i = 0; i < size_t(image.width) * size_t(image.height); ++i)
    count += std::any_of(image.channels.begin(), image.channels.end(),
                         [&](const Channel& c) { return c.type != ChannelType::uint32 && !std::isfinite(c.f[i]); });
  return count;
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

}  // namespace

std::vector<std::vector<float>> display_planes(const FloatImage& image, Encoding encoding) {
  std::array<const Channel*, 3> colour = {image.find("R"), image.find("G"), image.find("B")};
  if (const Channel* grey = image.find("Y"); grey && !colour[0]) colour = {grey, grey, grey};
  const Channel* alpha = image.find("A");
  if (encoding == Encoding::linear || (alpha && alpha->type == ChannelType::uint32)) alpha = nullptr;
  const auto within = [](float v) { return v > 0 ? std::min(v, 1.0f) : 0.0f; };  // NaN becomes 0
  std::vector<std::vector<float>> planes;
  for (const Channel* channel : colour) {
    if (!channel || channel->type == ChannelType::uint32) return {};
    std::vector<float>& plane = planes.emplace_back(channel->f);
    for (size_t i = 0; i < plane.size(); ++i) {
      plane[i] = within(plane[i]);
      if (encoding == Encoding::linear) plane[i] = srgb_from_linear(plane[i]);
      if (alpha) plane[i] *= within(alpha->f[i]);
    }
  }
  return planes;
}

namespace {

// As stored: scene-linear.
std::vector<Plane> linear_planes(const FloatImage& image) {
  std::vector<Plane> planes;
  for (const char* name : {"R", "G", "B"}) {
    const Channel* channel = image.find(name);
    if (!channel) channel = image.find("Y");
    if (!channel || channel->type == ChannelType::uint32) return {};
    planes.push_back(channel->f);
  }
  return planes;
}

struct Numbers {
  NumericResult result;
  std::optional<NoiseFloor> noise;
};
// noise_scale: NoiseMap::scale of the whole image, for a part of it too; negative: the reference does not know its
// noise.
Numbers numbers_of(const FloatImage& reference, const FloatImage& test, double noise_scale) {
  Numbers numbers;
  const std::vector<ChannelPair> channels = numeric_channels(reference, test);
  if (!channels.empty()) numbers.result = numeric_metrics(channels, reference.width, reference.height);
  numbers.result.metrics["differing"] =
      differing_pixels(all_channels(reference, test), reference.width, reference.height);
  if (noise_scale >= 0)
    if (auto map = noise_map(reference)) {
      map->scale = noise_scale;
      numbers.noise = noise_floor(*map, reference, test, channels.size());
    }
  return numbers;
}

struct Maps {
  Plane flip, hdr_flip;
};

RegionResult compare_region(const FloatImage& reference, const FloatImage& test, const CompareOptions& options,
                            const Region& region, const Maps& maps, double noise_scale) {
  const FloatImage a = crop(reference, region), b = crop(test, region);
  Numbers numbers = numbers_of(a, b, noise_scale);
  RegionResult result{.region = region,
                      .metrics = std::move(numbers.result.metrics),
                      .max_at = numbers.result.max_at,
                      .noise = numbers.noise};
  result.max_at.x += region.x, result.max_at.y += region.y;
  const auto shown_a = display_planes(a, options.encoding), shown_b = display_planes(b, options.encoding);
  if (shown_a.empty()) return result;
  result.metrics["psnr"] = psnr(shown_a, shown_b, a.width, a.height);
  if (options.perceptual) result.metrics["ssim"] = ssim(shown_a, shown_b, a.width, a.height);
  // Of the whole image's map: what lies beside a region is seen with it.
  const auto mean_within = [&](const Plane& map) {
    return flip_mean(crop(map, reference.width, region), a.width, a.height);
  };
  if (!maps.flip.empty()) result.metrics["flip"] = mean_within(maps.flip);
  if (!maps.hdr_flip.empty()) result.metrics["hdr-flip"] = mean_within(maps.hdr_flip);
  return result;
}

void add_display_metrics(const FloatImage& reference, const FloatImage& test, const CompareOptions& options, Maps& maps,
                         Comparison& result) {
  const auto a = display_planes(reference, options.encoding), b = display_planes(test, options.encoding);
  if (a.empty()) return;
  const int width = result.width, height = result.height;
  result.metrics["psnr"] = psnr(a, b, width, height);
  if (options.perceptual) {
    result.metrics["ssim"] = ssim(a, b, width, height);
    maps.flip = flip_map(a, b, width, height);
    result.metrics["flip"] = flip_mean(maps.flip, width, height);
  }
  if (options.hdr_flip && options.encoding == Encoding::linear) {
    const std::vector<Plane> linear = linear_planes(reference);
    result.exposures = options.hdr_flip->range ? *options.hdr_flip->range : automatic_exposures(linear);
    maps.hdr_flip = hdr_flip_map(linear, linear_planes(test), width, height, *result.exposures);
    result.metrics["hdr-flip"] = flip_mean(maps.hdr_flip, width, height);
  }
}

}  // namespace

Comparison compare(const FloatImage& reference, const FloatImage& test, const CompareOptions& options) {
  Comparison result{.width = reference.width, .height = reference.height};
  result.nonfinite_reference = nonfinite_pixels(reference), result.nonfinite_test = nonfinite_pixels(test);
  result.refusal = refusal_of(reference, test, result.nonfinite_in_both);
  for (const Region& region : options.regions)
    if (const auto within = check_region(region, reference.width, reference.height); !within && result.refusal.empty())
      result.refusal = within.error().message;
  if (!result.refusal.empty()) return result;
  if (opaque_alpha_alone(reference, test))
    result.notes.push_back(fmt::format("the {} image alone has alpha, which is 1 everywhere: the colours are compared",
                                       reference.find("A") ? "reference" : "test"));
  const auto noise = noise_map(reference);
  const double noise_scale = noise ? noise->scale : -1;
  Numbers numbers = numbers_of(reference, test, noise_scale);
  result.metrics = std::move(numbers.result.metrics);
  result.max_at = std::move(numbers.result.max_at);
  result.noise = numbers.noise;
  Maps maps;
  add_display_metrics(reference, test, options, maps, result);
  if (options.layers) result.layers = compare_layers(reference, test);
  for (const Region& region : options.regions)
    result.regions.push_back(compare_region(reference, test, options, region, maps, noise_scale));
  result.flip_map = std::move(maps.flip);
  return result;
}

namespace {

// The layers of `from` that `other` has not, or has only in part.
std::vector<std::string> layers_alone(const FloatImage& from, const FloatImage& other) {
  std::set<std::string> alone;
  for (const Channel& channel : from.channels)
    if (const std::string layer = layer_of(channel); !layer.empty() && layer != "variance" && !other.find(channel.name))
      alone.insert(layer);
  return {alone.begin(), alone.end()};
}

}  // namespace

Encoding encoding_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending == ".exr" || ending == ".hdr" ? Encoding::linear : Encoding::display;
}

Expected<Comparison> compare_files(const std::filesystem::path& reference, const std::filesystem::path& test,
                                   CompareOptions options) {
  auto a = read_image(reference);
  if (!a) return std::unexpected(a.error());
  auto b = read_image(test);
  if (!b) return std::unexpected(b.error());
  options.encoding = encoding_of(reference);
  if (options.encoding != encoding_of(test))
    return Comparison{.refusal = "one file is scene-linear, the other display-encoded: no metric has a meaning",
                      .width = a->width,
                      .height = a->height};
  const std::vector<SharedLevels> shared_levels = keep_shared_levels(*a, *b);
  Comparison result = compare(*a, *b, options);
  result.shared_levels = shared_levels;
  result.only_in_reference = layers_alone(*a, *b);
  result.only_in_test = layers_alone(*b, *a);
  return result;
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
