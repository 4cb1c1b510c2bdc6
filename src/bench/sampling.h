#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/statistics.h"

namespace candela {

// How many times a configuration is measured (DESIGN section 6).
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
struct NoiseRules {
  double min_relative = 0.05;  // smaller changes are not reported, however sure
  double mads = 4;             // a change must exceed so many of the larger MAD
  size_t min_count = 3;
};
Judgement judge(std::span<const double> before, std::span<const double> after, const NoiseRules& rules);

// What two configurations say about each other that were measured in the same rounds: the difference of each pair,
// whose common disturbances cancel.
enum class Order { less, greater, equal, unclear };  // unclear: not distinguishable; equal: all pairs are equal
struct PairedOrder {
  Order order = Order::unclear;
  Interval difference;  // 95 % of the median of a - b
};
// Below so many pairs nothing is distinguished: the range of six holds the median in 97 % of all cases, of five in 94
// %.
inline constexpr size_t least_pairs = 6;
// a[i] and b[i] are a pair; what one has more is left out.
PairedOrder paired_order(std::span<const double> a, std::span<const double> b);

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
