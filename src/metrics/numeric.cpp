#include "metrics/numeric.h"

#include <bit>
#include <numeric>

#include "base/check.h"
#include "metrics/planes.h"

namespace candela {
namespace {

struct Row {
  double absolute = 0, square = 0, relative = 0;
  double largest = 0;
  Place at;
};

}  // namespace

double sorted_percentile(std::span<const float> sorted, double fraction) {
  if (sorted.empty()) return 0;
  const double rank = fraction * double(sorted.size() - 1);
  const size_t low = size_t(rank), high = std::min(low + 1, sorted.size() - 1);
  return double(sorted[low]) + (double(sorted[high]) - double(sorted[low])) * (rank - double(low));
}

NumericResult numeric_metrics(std::span<const ChannelPair> channels, int width, int height) {
  CHECK(!channels.empty());
  const size_t pixels = size_t(width) * size_t(height);
  std::vector<Row> rows(static_cast<size_t>(height));
  std::vector<float> largest(pixels, 0.0f);   // of each pixel, over its channels
  std::vector<double> relative(pixels, 0.0);  // as well; squares of large floats are beyond them
  sum_rows(height, [&](int y) {
    Row& row = rows[size_t(y)];
    for (const auto& [from, to] : channels)
      for (int x = 0; x < width; ++x) {
        const size_t i = size_t(y) * size_t(width) + size_t(x);
        if (!std::isfinite(from->f[i])) continue;
        const double r = from->f[i], d = std::abs(double(to->f[i]) - r);
        if (d > row.largest) row.largest = d, row.at = {x, y, from->name};
        const double fraction = d * d / (r * r + relmse_epsilon);
        row.absolute += d;
        row.square += d * d;
        row.relative += fraction;
        largest[i] = std::max(largest[i], float(d));
        relative[i] += fraction;
      }
    return 0.0;
  });
  Row all;
  for (const Row& row : rows) {
    if (row.largest > all.largest) all.largest = row.largest, all.at = row.at;
    all.absolute += row.absolute, all.square += row.square, all.relative += row.relative;
  }
  const double count = double(channels.size()) * double(pixels);
  NumericResult result{.max_at = all.at};
  result.metrics = {{"max", all.largest},
                    {"mae", all.absolute / count},
                    {"rmse", std::sqrt(all.square / count)},
                    {"relmse", all.relative / count}};
  std::sort(largest.begin(), largest.end());
  for (const auto& [name, fraction] :
       {std::pair("p50", 0.5), std::pair("p90", 0.9), std::pair("p99", 0.99), std::pair("p99.9", 0.999)})
    result.metrics[name] = sorted_percentile(largest, fraction);
  // Rounded down: a picture of fewer than a thousand pixels is not trimmed.
  std::sort(relative.begin(), relative.end());
  const size_t kept = pixels - size_t(trimmed_fraction * double(pixels));
  const double rest = std::accumulate(relative.begin(), relative.begin() + std::ptrdiff_t(kept), 0.0);
  result.metrics["relmse-trimmed"] =
      kept == pixels ? result.metrics["relmse"] : rest / (double(channels.size()) * double(kept));
  return result;
}

double differing_pixels(std::span<const ChannelPair> channels, int width, int height) {
  return sum_rows(height, [&](int y) {
    size_t count = 0;
    for (size_t i = size_t(y) * size_t(width); i < size_t(y + 1) * size_t(width); ++i)
      count += std::any_of(channels.begin(), channels.end(), [&](const ChannelPair& pair) {
        if (pair.first->type == ChannelType::uint32) return pair.first->u[i] != pair.second->u[i];
        return std::bit_cast<uint32_t>(pair.first->f[i]) != std::bit_cast<uint32_t>(pair.second->f[i]);
      });
    return double(count);
  });
}

}  // namespace candela
