#include "bench/sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "base/rng.h"
#include "base/statistics.h"

namespace candela {

bool warmed_up(std::span<const double> frames_ms, const SamplingRules& rules) {
  if (frames_ms.empty()) return rules.max_warm_up <= 0;
  if (int(frames_ms.size()) >= rules.max_warm_up) return true;
  if (std::accumulate(frames_ms.begin(), frames_ms.end(), 0.0) >= rules.warm_up_s * 1000) return true;
  constexpr size_t window = 3;
  if (frames_ms.size() < window) return false;
  const auto [low, high] = std::minmax_element(frames_ms.end() - window, frames_ms.end());
  return *high <= *low * 1.05;
}

RunCount runs_needed(std::span<const double> pilot, const SamplingRules& rules) {
  const double middle = median(pilot);
  const double spread = middle > 0 ? 1.4826 * mad(pilot) / middle : 0;
  const double wanted = std::ceil(std::pow(1.2533 * spread / rules.precision, 2));
  const int lowest = std::max(1, rules.min_runs), highest = std::max(lowest, rules.max_runs);
  if (wanted > highest) return {highest, true};
  return {std::max(lowest, int(wanted)), false};
}

Summary summary(std::span<const double> samples) {
  if (samples.empty()) return {};
  return {median(samples), mad(samples), *std::min_element(samples.begin(), samples.end()), samples.size()};
}

std::vector<size_t> round_order(size_t count, uint64_t seed, int round) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t(0));
  Rng rng(seed * 0x9e3779b97f4a7c15u + uint64_t(round));
  for (size_t i = count; i > 1; --i) std::swap(order[i - 1], order[rng.next() % i]);
  return order;
}

Judgement judge(std::span<const double> before, std::span<const double> after, const NoiseRules& rules) {
  Judgement j;
  j.old_median = median(before);
  j.new_median = median(after);
  j.bound = std::max(rules.min_relative * j.old_median, rules.mads * std::max(mad(before), mad(after)));
  if (before.size() < rules.min_count || after.size() < rules.min_count) return j;
  const double change = j.new_median - j.old_median;
  j.verdict = change > j.bound ? Verdict::slower : change < -j.bound ? Verdict::faster : Verdict::same;
  return j;
}

PairedOrder paired_order(std::span<const double> a, std::span<const double> b) {
  std::vector<double> differences;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) differences.push_back(a[i] - b[i]);
  PairedOrder result{.difference = median_interval(differences)};
  if (differences.size() < least_pairs) return result;
  const auto [low, high] = result.difference;
  if (std::all_of(differences.begin(), differences.end(), [](double d) { return d == 0; }))
    result.order = Order::equal;
  else if (high < 0 || low > 0)
    result.order = high < 0 ? Order::less : Order::greater;
  return result;
}

Interval mean_interval(std::span<const double> samples) {
  if (samples.empty()) return {};
  const double n = double(samples.size()), mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  if (samples.size() == 1) return {mean, mean};
  double squares = 0;
  for (const double s : samples) squares += (s - mean) * (s - mean);
  // Two-sided 95 % quantiles for 1 to 10 degrees of freedom; beyond, the series of Fisher and Cornish (1960) to its
  // second term, which is good to a thousandth there.
  static constexpr double quantiles[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  constexpr double z = 1.95996;
  const double df = n - 1;
  const double t =
      df <= 10 ? quantiles[size_t(df) - 1]
               : z + (z * z * z + z) / (4 * df) + (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * df * df);
  const double half = t * std::sqrt(squares / df / n);
  return {mean - half, mean + half};
}

PowerFit fit_power(std::span<const double> x, std::span<const double> y) {
  CHECK(x.size() == y.size());
  PowerFit fit;
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    fit.first_x = fit.points == 0 ? x[i] : std::min(fit.first_x, x[i]);
    fit.last_x = fit.points == 0 ? x[i] : std::max(fit.last_x, x[i]);
    ++fit.points;
    const double log_x = std::log(x[i]), log_y = std::log(y[i]);
    sum_x += log_x, sum_y += log_y, sum_xx += log_x * log_x, sum_xy += log_x * log_y;
  }
  const double n = double(fit.points), spread = n * sum_xx - sum_x * sum_x;
  if (fit.points < 2 || fit.first_x == fit.last_x) return {.points = fit.points < 2 ? fit.points : 1};
  fit.exponent = (n * sum_xy - sum_x * sum_y) / spread;
  fit.factor = std::exp((sum_y - fit.exponent * sum_x) / n);
  return fit;
}

}  // namespace candela
