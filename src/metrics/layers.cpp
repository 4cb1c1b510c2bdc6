#include "metrics/layers.h"

namespace candela {
namespace {

constexpr float background_depth_m = 1e10f;  // docs/using/outputs.md

// Sets PREFIX-mean, PREFIX-p99 and PREFIX-max.
void add_spread(std::vector<float>& values, const std::string& prefix, std::map<std::string, double>& metrics) {
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const float v : values) sum += v;
  metrics[prefix + "-mean"] = values.empty() ? 0 : sum / double(values.size());
  metrics[prefix + "-p99"] = sorted_percentile(values, 0.99);
  metrics[prefix + "-max"] = values.empty() ? 0 : values.back();
}

void note_largest(double value, double& largest, size_t i, int width, const std::string& channel, Place& at) {
  if (value > largest) largest = value, at = {int(i % size_t(width)), int(i / size_t(width)), channel};
}

void compare_depth(const ChannelPair& z, int width, LayerResult& result) {
  std::vector<float> errors;
  double largest = 0, one_sided = 0;
  for (size_t i = 0; i < z.first->f.size(); ++i) {
    const double a = z.first->f[i], b = z.second->f[i];
    const bool surface_a = std::isfinite(a) && a < background_depth_m,
               surface_b = std::isfinite(b) && b < background_depth_m;
    if (surface_a != surface_b) one_sided += 1;
    if (!surface_a || !surface_b) continue;
    const double error = a == b ? 0 : std::abs(b - a) / std::max(std::abs(a), 1e-12);
    note_largest(error, largest, i, width, z.first->name, result.max_at);
    errors.push_back(float(error));
  }
  add_spread(errors, "depth-rel", result.metrics);
  result.metrics["one-sided"] = one_sided;
}

void compare_normals(const std::vector<ChannelPair>& xyz, int width, LayerResult& result) {
  std::vector<float> errors;
  double largest = 0, one_sided = 0;
  for (size_t i = 0; i < xyz[0].first->f.size(); ++i) {
    double aa = 0, bb = 0, cross = 0, dot = 0;
    double a[3], b[3];
    for (size_t c = 0; c < 3; ++c) {
      a[c] = xyz[c].first->f[i], b[c] = xyz[c].second->f[i];
      aa += a[c] * a[c], bb += b[c] * b[c], dot += a[c] * b[c];
    }
    const bool some_a = aa > 0 && std::isfinite(aa), some_b = bb > 0 && std::isfinite(bb);
    if (some_a != some_b) one_sided += 1;
    if (!some_a || !some_b) continue;
    for (size_t c = 0; c < 3; ++c) {
      const double v = a[c] * b[(c + 1) % 3] - a[(c + 1) % 3] * b[c];
      cross += v * v;
    }
    // atan2 keeps small angles, where the cosine is 1 for all of them.
    const double degrees = std::atan2(std::sqrt(cross), dot) * 180 / 3.14159265358979323846;
    note_largest(degrees, largest, i, width, result.name, result.max_at);
    errors.push_back(float(degrees));
  }
  add_spread(errors, "angle", result.metrics);
  result.metrics["one-sided"] = one_sided;
}

// Layers that the file says are Cryptomatte's.
std::vector<std::string> matte_layers(const FloatImage& image) {
  std::vector<std::string> layers;
  for (const MetadataEntry& entry : image.metadata)
    if (entry.name.starts_with("cryptomatte/") && entry.name.ends_with("/name")) layers.push_back(entry.text);
  return layers;
}

std::string matte_level(const std::string& layer, int level) { return fmt::format("{}{:02}", layer, level); }

int matte_levels(const FloatImage& image, const std::string& layer) {
  int levels = 0;
  while (image.find(matte_level(layer, levels) + ".R")) ++levels;
  return levels;
}

// "crypto_object01" of the layer crypto_object: its floats are bits.
bool is_matte_level(const FloatImage& image, const std::string& name) {
  return std::ranges::any_of(matte_layers(image), [&](const std::string& layer) {
    return name.starts_with(layer) && name.size() == layer.size() + 2;
  });
}

LayerResult compare_layer(const std::string& name, const std::vector<ChannelPair>& channels, bool matte, int width,
                          int height) {
  using Kind = LayerResult::Kind;
  LayerResult result{.name = name};
  const bool ids = matte || channels[0].first->type == ChannelType::uint32;
  if (ids)
    result.kind = Kind::ids;
  else if (name == "depth" && channels.size() == 1)
    result.kind = Kind::depth;
  else if (name == "normal" && channels.size() == 3)
    result.kind = Kind::normals;
  switch (result.kind) {
    case Kind::ids:
      break;
    case Kind::depth:
      compare_depth(channels[0], width, result);
      break;
    case Kind::normals:
      compare_normals(channels, width, result);
      break;
    case Kind::values: {
      NumericResult numbers = numeric_metrics(channels, width, height);
      result.metrics = std::move(numbers.metrics);
      result.max_at = std::move(numbers.max_at);
    }
  }
  const double differing = differing_pixels(channels, width, height);
  result.metrics["differing"] = differing;
  if (ids) result.metrics["differing-share"] = differing / (double(width) * double(height));
  return result;
}

}  // namespace

std::string_view layer_kind_name(LayerResult::Kind kind) {
  constexpr std::array<std::string_view, 4> names = {"ids", "depth", "normals", "values"};
  return names[size_t(kind)];
}

std::string layer_of(const Channel& channel) {
  const size_t dot = channel.name.rfind('.');
  if (dot != std::string::npos) return channel.name.substr(0, dot);
  const bool beauty = channel.name.size() == 1 && std::string_view("RGBAY").contains(channel.name[0]);
  return beauty ? "" : channel.name;
}

std::vector<SharedLevels> keep_shared_levels(FloatImage& reference, FloatImage& test) {
  std::vector<SharedLevels> unequal;
  for (const std::string& layer : matte_layers(reference)) {
    const SharedLevels levels{layer, matte_levels(reference, layer), matte_levels(test, layer)};
    if (levels.shared() == 0 || levels.reference == levels.test) continue;
    for (FloatImage* image : {&reference, &test})
      for (int level = levels.shared(); level < std::max(levels.reference, levels.test); ++level)
        std::erase_if(image->channels,
                      [&](const Channel& channel) { return layer_of(channel) == matte_level(layer, level); });
    unequal.push_back(levels);
  }
  return unequal;
}

std::vector<LayerResult> compare_layers(const FloatImage& reference, const FloatImage& test) {
  std::map<std::string, std::vector<ChannelPair>> layers;
  for (const Channel& channel : reference.channels) {
    const std::string layer = layer_of(channel);
    if (layer.empty() || layer == "variance") continue;
    const Channel* other = test.find(channel.name);
    if (other && (other->type == ChannelType::uint32) == (channel.type == ChannelType::uint32))
      layers[layer].emplace_back(&channel, other);
  }
  std::vector<LayerResult> results;
  for (const auto& [name, channels] : layers) {
    const bool mixed = std::any_of(channels.begin(), channels.end(), [&](const ChannelPair& pair) {
      return (pair.first->type == ChannelType::uint32) != (channels[0].first->type == ChannelType::uint32);
    });
    if (!mixed)
      results.push_back(compare_layer(name, channels, is_matte_level(reference, name) && is_matte_level(test, name),
                                      reference.width, reference.height));
  }
  return results;
}

}  // namespace candela
