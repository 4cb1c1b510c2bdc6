#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/statistics.h"

namespace candela {

// How many times a configuration is measured.
struct SamplingRules {
  double precision = 0.01;  // wanted standard error of the median, as a part of it
  int min_runs = 5;         // the pilot
  int max_runs = 64;        // the cap; a row that hit it says so
  int max_warm_up = 10;     // frames
  double warm_up_s = 2;     // no longer than this, but at least one frame
  int max_sessions = 0;     // configurations held open at once; 0: as the device allows
  uint64_t order_seed = 1;  // of the order within a round
};

// Warm-up is over when the last three frames are within 5 % of each other, or at a limit.
bool warmed_up(std::span<const double> frames_ms, const SamplingRules& rules);

struct RunCount {
  int runs = 0;
  bool capped = false;  // more would have been needed for the precision
};
// From the pilot's spread. For a normal distribution the median of n runs has the standard error 1.2533 sigma /
// sqrt(n), and sigma is 1.4826 MAD (Rousseeuw, Croux, "Alternatives to the Median Absolute Deviation", 1993).
RunCount runs_needed(std::span<const double> pilot, const SamplingRules& rules);

struct Summary {
  double median = 0, mad = 0, min = 0;
  size_t count = 0;
};
Summary summary(std::span<const double> samples);

// 0..count-1 shuffled: the order of one round. Fixed orders would let each configuration always follow the same other.
std::vector<size_t> round_order(size_t count, uint64_t seed, int round);

// What two sets of samples of the same thing say about each other.
enum class Verdict { same, slower, faster, unclear };  // unclear: too few samples to tell
struct Judgement {
  Verdict verdict = Verdict::unclear;
  double old_median = 0, new_median = 0;
  double bound = 0;  // differences up to this are noise, in the samples' unit
  double ratio() const { return old_median > 0 ? new_median / old_median : 0; }
};
// How many times as long the second takes, with 95 % confidence in each of `comparisons` such statements together
// (Bonferroni): Welch's t on the logarithms ("The Generalization of 'Student's' Problem", 1947), of runs that share
// nothing. Without two samples of each, from 0 to infinity.
Interval ratio_interval(std::span<const double> before, std::span<const double> after, size_t comparisons = 1);

struct NoiseRules {
  double min_relative = 0.05;  // smaller changes are not reported, however sure
  double mads = 4;             // a change must exceed so many of the larger MAD
  size_t min_count = 3;
};
Judgement judge(std::span<const double> before, std::span<const double> after, const NoiseRules& rules);

// What two configurations say about each other. docs/understanding/deciding.md is the whole rule, with its reasons.
enum class Order { less, greater, equal, unclear };  // unclear: not distinguishable; equal: all pairs are equal
struct Decision {
  Order order = Order::unclear;
  double p = 1;  // how likely so large a difference is between equals
};
// Of one in 20, less what outliers add, which no test takes into account.
inline constexpr double sure_p = 0.04;
// By pairs that were measured in the same rounds, or of the same views, whose common disturbances cancel: Student's t
// for paired samples (1908) on the logarithms of their ratios, or on their differences where a value is not positive.
// From eight pairs on the smallest and the largest are left out and the variance is winsorized (Yuen, "The Two-Sample
// Trimmed t for Unequal Population Variances", 1974), so that one outlier on each side decides nothing. Fewer than
// `least_pairs` say nothing. a[i] and b[i] are a pair; what one has more is left out. most_p: where more is not sure.
inline constexpr size_t least_pairs = 4;
Decision paired_order(std::span<const double> a, std::span<const double> b, double most_p = sure_p);

// How much times vary in a run, as standard deviations of their logarithms: between samples of one row, and of a row
// that was measured again and again, between the times at which that was done.
struct TimeNoise {
  double samples = 0.1, moments = 0.05;  // where nothing was measured often enough
  double degrees = 1e9;                  // of freedom of `samples`
};
// `samples` and `degrees` of the rows' samples, by median absolute deviations from each row's median.
TimeNoise noise_of(const std::vector<std::span<const double>>& rows);
// Of what was not measured in pairs, or in too few: the least samples, as many of each, by a Student's t with the noise
// of the whole run, which is taken to be at least 2 %.
Decision order_of_samples(std::span<const double> a, std::span<const double> b, const TimeNoise& noise,
                          double most_p = sure_p);

// Where the median of a row's time lies with 95 % confidence: of six samples and more median_interval(), whose range
// holds it; of fewer, whose range does not, by the noise of the run. Empty samples: 0.
Interval time_interval(std::span<const double> samples, const TimeNoise& noise);

// Of many comparisons the p up to which a difference is sure, so that of all that are called sure at most one in twenty
// is false, and where nothing differs none is called so in 19 of 20 runs (Benjamini, Hochberg, "Controlling the False
// Discovery Rate", 1995).
double most_sure_p(std::vector<double> of_all);

// The probability that a Student's t of so many degrees of freedom is as far from 0, on either side.
double student_two_sided(double t, double degrees);
double student_quantile(double two_sided, double degrees);  // its inverse

// The mean of what the samples come from, with 95 % confidence (Student, "The Probable Error of a Mean", 1908); of one
// sample that sample.
Interval mean_interval(std::span<const double> samples);

// y = factor * x^exponent by least squares on logarithms.
struct PowerFit {
  double factor = 0, exponent = 0;
  double first_x = 0, last_x = 0;  // the range fitted
  size_t points = 0;               // below 2 there is no fit
};
PowerFit fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace candela
