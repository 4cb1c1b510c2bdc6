#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/rng.h"

namespace candela {
double percentile(std::span<const double> samples, double fraction) {
  if (samples.empty()) return 0;
  std::vector<double> sorted(samples.begin(), samples.end());
  std::sort(sorted.begin(), sorted.end());
  const double at = std::clamp(fraction, 0.0, 1.0) * double(sorted.size() - 1);
  const size_t below = size_t(at);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (sorted[above] - sorted[below]) * (at - double(below));
}
double median(std::span<const double> samples) { return percentile(samples, 0.5); }
double mad(std::span<const double> samples) {
  const double middle = median(samples);
  std::vector<double> distance;
  for (double s : samples) distance.push_back(std::abs(s - middle));
  return median(distance);
}
Interval median_interval(std::span<const double> samples, const Bootstrap& bootstrap) {
  if (samples.empty()) return {};
  std::vector<double> sorted(samples.begin(), samples.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.front() == sorted.back()) return {sorted.front(), sorted.front()};
  Rng rng(bootstrap.seed);
  const size_t n = sorted.size(), middle = n / 2;
  std::vector<double> medians;
  std::vector<size_t> ranks(n);
  for (int i = 0; i < bootstrap.resamples; ++i) {
    for (size_t& rank : ranks) rank = size_t(rng.uniform() * double(n));
    // Ranks order as their values do, and are quicker to compare.
    std::nth_element(ranks.begin(), ranks.begin() + std::ptrdiff_t(middle), ranks.end());
    const double above = sorted[ranks[middle]];
    const double below = n % 2 == 1 ? above : sorted[*std::max_element(ranks.begin(), ranks.begin() + std::ptrdiff_t(middle))];
    medians.push_back(below + (above - below) / 2);
  }
  const double tail = (1 - bootstrap.confidence) / 2;
  return {percentile(medians, tail), percentile(medians, 1 - tail)};
}
}  // namespace candela
