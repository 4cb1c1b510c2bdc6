#include "metrics/noise_floor.h"

#include "metrics/numeric.h"

namespace candela {
namespace {

constexpr std::array<const char*, 3> colours = {"R", "G", "B"};

std::optional<double> number_of(const FloatImage& image, std::string_view name) {
  for (const MetadataEntry& entry : image.metadata)
    if (entry.name == name && entry.kind != MetadataEntry::Kind::text && entry.kind != MetadataEntry::Kind::matrix44)
      return entry.number;
  return {};
}

double positive(float variance) { return std::isfinite(variance) && variance > 0 ? double(variance) : 0.0; }

}  // namespace

std::optional<NoiseMap> noise_map(const FloatImage& reference) {
  NoiseMap map;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    map.variance[c] = reference.find(std::string("variance.") + colours[c]);
    if (!map.variance[c] || map.variance[c]->type == ChannelType::uint32 || !reference.find(colours[c])) return {};
    for (const float v : map.variance[c]->f) sum += positive(v);
  }
  if (const auto spp = number_of(reference, "candela:spp"); spp && *spp < 2) return {};
  const double mean = sum / (3 * double(reference.width) * double(reference.height));
  if (const auto mse = number_of(reference, "candela:mse"); mse && *mse >= 0 && mean > 0) map.scale = *mse / mean;
  return map;
}

NoiseFloor noise_floor(const NoiseMap& map, const FloatImage& reference, const FloatImage& test, size_t channels) {
  double square = 0, relative = 0, of_relative = 0;
  for (size_t c = 0; c < 3; ++c) {
    const Channel& colour = *reference.find(colours[c]);
    const Channel* shown = test.find(colours[c]);
    for (size_t i = 0; i < colour.f.size(); ++i) {
      const double variance = positive(map.variance[c]->f[i]) * map.scale, r = colour.f[i];
      square += variance;
      if (!std::isfinite(r)) continue;
      const double weight = 1 / (r * r + relmse_epsilon);
      relative += variance * weight;
      // (d + n)^2 of a difference d and a normal noise n has the variance 4 d^2 s^2 + 2 s^4, and d^2 + s^2 is what is
      // seen of it: 4 seen s^2 is no less.
      const double seen = shown ? double(shown->f[i]) - r : 0;
      if (std::isfinite(seen)) of_relative += 4 * seen * seen * variance * weight * weight;
    }
  }
  const double count = double(std::max<size_t>(channels, 1)) * double(reference.width) * double(reference.height);
  return {std::sqrt(square / count), relative / count, std::sqrt(of_relative) / count};
}

}  // namespace candela
