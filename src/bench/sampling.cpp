#include "bench/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/check.h"
#include "base/rng.h"
#include "base/statistics.h"
#include "passes/transparency/moments.h"

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

namespace {

// Continued fraction of the incomplete beta function (Abramowitz, Stegun 1964, 26.5.8), by the modified method of
// Lentz.
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double value = d;
  for (int m = 1; m <= 500; ++m) {
    const auto step = [&](double term) {
      d = 1 + term * d, c = 1 + term / c;
      d = 1 / (std::abs(d) < tiny ? tiny : d), c = std::abs(c) < tiny ? tiny : c;
      value *= d * c;
      return std::abs(d * c - 1);
    };
    step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
    if (step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))) < 1e-14) break;
  }
  return value;
}

// The regularized incomplete beta function.
double incomplete_beta(double a, double b, double x) {
  if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

struct TStatistic {
  double mean = 0, error = 0, degrees = 0;
};
TStatistic trimmed_t(std::vector<double> d) {
  std::sort(d.begin(), d.end());
  const size_t cut = d.size() >= 8 ? 1 : 0;
  const double n = double(d.size()), kept = n - 2 * double(cut);
  TStatistic t{.degrees = kept - 1};
  for (size_t i = cut; i + cut < d.size(); ++i) t.mean += d[i] / kept;
  double winsorized = 0, squares = 0;
  const auto clipped = [&](size_t i) { return d[std::clamp(i, cut, d.size() - 1 - cut)]; };
  for (size_t i = 0; i < d.size(); ++i) winsorized += clipped(i) / n;
  for (size_t i = 0; i < d.size(); ++i) squares += (clipped(i) - winsorized) * (clipped(i) - winsorized);
  t.error = std::sqrt(squares / (kept * (kept - 1)));
  return t;
}

Decision decided(double difference, double p, double most_p) {
  if (!(p <= most_p)) return {Order::unclear, p};
  return {difference < 0 ? Order::less : Order::greater, p};
}

}  // namespace

double student_two_sided(double t, double degrees) {
  if (!std::isfinite(t)) return 0;
  if (degrees > 1e7) return std::erfc(std::abs(t) / std::sqrt(2.0));
  return incomplete_beta(degrees / 2, 0.5, degrees / (degrees + t * t));
}

double student_quantile(double two_sided, double degrees) {
  double low = 0, high = 1;
  while (student_two_sided(high, degrees) > two_sided && high < 1e12) high *= 2;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (student_two_sided(middle, degrees) > two_sided ? low : high) = middle;
  }
  return high;
}

TimeNoise noise_of(const std::vector<std::span<const double>>& rows) {
  TimeNoise noise;
  std::vector<double> residuals;
  double degrees = 0;
  for (const std::span<const double> samples : rows) {
    const double middle = median(samples), n = double(samples.size());
    if (n < 2 || middle <= 0) continue;
    degrees += n - 1;
    for (const double s : samples)
      if (s > 0) residuals.push_back(std::abs(std::log(s / middle)) * std::sqrt(n / (n - 1)));
  }
  constexpr double normal = 1.4826;  // sigma of a normal distribution over its median absolute deviation
  if (degrees >= 4) noise.samples = normal * median(residuals), noise.degrees = degrees;
  return noise;
}

Interval time_interval(std::span<const double> samples, const TimeNoise& noise) {
  constexpr size_t whole = 6;  // their range holds the median in 97 % of all cases
  const double middle = median(samples);
  if (samples.size() >= whole || samples.empty() || !(middle > 0)) return median_interval(samples);
  constexpr double least = 0.02, of_median = 1.2533;
  const double within = of_median * std::max(noise.samples, least) / std::sqrt(double(samples.size()));
  const double error = std::hypot(within, std::max(noise.moments, least));
  const double half = student_quantile(0.05, noise.degrees) * error;
  const Interval seen = median_interval(samples);
  return {std::min(seen.low, middle * std::exp(-half)), std::max(seen.high, middle * std::exp(half))};
}

Decision paired_order(std::span<const double> a, std::span<const double> b, double most_p) {
  const size_t n = std::min(a.size(), b.size());
  if (n < least_pairs) return {};
  bool positive = true, same = true;
  for (size_t i = 0; i < n; ++i) positive = positive && a[i] > 0 && b[i] > 0, same = same && a[i] == b[i];
  if (same) return {Order::equal, 1};
  std::vector<double> tested;
  for (size_t i = 0; i < n; ++i) tested.push_back(positive ? std::log(a[i] / b[i]) : a[i] - b[i]);
  const TStatistic t = trimmed_t(std::move(tested));
  return decided(t.mean, t.error > 0 ? student_two_sided(t.mean / t.error, t.degrees) : t.mean == 0 ? 1 : 0, most_p);
}

Decision order_of_samples(std::span<const double> a, std::span<const double> b, const TimeNoise& noise, double most_p) {
  // The least of more samples would be less. It varies by about n^(-1/4) of what a sample does.
  const size_t n = std::min(a.size(), b.size());
  if (n == 0) return {};
  const double of_a = *std::min_element(a.begin(), a.begin() + std::ptrdiff_t(n));
  const double of_b = *std::min_element(b.begin(), b.begin() + std::ptrdiff_t(n));
  if (!(of_a > 0 && of_b > 0)) return {};
  constexpr double least = 0.02, tails = 1.25;  // tails: of outliers, which a median deviation does not see
  const double samples = tails * std::max(noise.samples, least) * std::pow(double(n), -0.25);
  const double moments = std::max(noise.moments, least);
  const double error = std::sqrt(2 * (samples * samples + moments * moments)), difference = std::log(of_a / of_b);
  return decided(difference, student_two_sided(difference / error, noise.degrees), most_p);
}

double most_sure_p(std::vector<double> of_all) {
  std::sort(of_all.begin(), of_all.end());
  double most = 0;
  for (size_t k = 0; k < of_all.size(); ++k)
    if (const double level = sure_p * double(k + 1) / double(of_all.size()); of_all[k] <= level) most = level;
  return most;
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

Interval ratio_interval(std::span<const double> before, std::span<const double> after, size_t comparisons) {
  Interval ratio{0, std::numeric_limits<double>::infinity()};
  struct Moments {
    double n = 0, mean = 0, variance = 0;  // of logarithms; variance of the mean
  };
  const auto moments = [](std::span<const double> samples) {
    Moments m{.n = double(samples.size())};
    for (const double s : samples) m.mean += std::log(s) / m.n;
    for (const double s : samples) m.variance += std::pow(std::log(s) - m.mean, 2) / (m.n * (m.n - 1));
    return m;
  };
  const auto usable = [](std::span<const double> s) {
    return s.size() >= 2 && std::ranges::all_of(s, [](double v) { return v > 0; });
  };
  if (!usable(before) || !usable(after)) return ratio;
  const Moments a = moments(before), b = moments(after);
  const double variance = a.variance + b.variance, middle = b.mean - a.mean;
  if (variance == 0) return {std::exp(middle), std::exp(middle)};
  const double degrees =
      variance * variance / (a.variance * a.variance / (a.n - 1) + b.variance * b.variance / (b.n - 1));
  const double half = student_quantile(0.05 / double(std::max<size_t>(comparisons, 1)), degrees) * std::sqrt(variance);
  return {std::exp(middle - half), std::exp(middle + half)};
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
