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
  const size_t n = sorted.size();
  const auto lower = std::ptrdiff_t((n - 1) / 2), upper = std::ptrdiff_t(n / 2);
  // Of ranks: they order as their values do.
  std::vector<double> low, high, ranks(n);
  for (int i = 0; i < bootstrap.resamples; ++i) {
    for (double& rank : ranks) rank = std::floor(rng.uniform() * double(n));
    std::nth_element(ranks.begin(), ranks.begin() + upper, ranks.end());
    high.push_back(ranks[size_t(upper)]);
    low.push_back(lower == upper ? high.back() : *std::max_element(ranks.begin(), ranks.begin() + upper));
  }
  const double tail = (1 - bootstrap.confidence) / 2;
  return {sorted[size_t(percentile(low, tail))], sorted[size_t(std::ceil(percentile(high, 1 - tail)))]};
}
}  // namespace candela
