#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

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
}  // namespace candela
