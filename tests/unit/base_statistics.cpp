#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "base/statistics.h"

namespace candela {
namespace {

// Between two ranks the value lies on the line between theirs.
TEST(Percentile, LiesBetweenTheRanks) {
  const std::vector<double> samples = {40, 10, 30, 20};
  EXPECT_EQ(median(samples), 25);
  EXPECT_DOUBLE_EQ(percentile(samples, 0.25), 17.5);
  EXPECT_EQ(percentile(samples, 0), 10);
  EXPECT_EQ(percentile(samples, 1), 40);
  EXPECT_EQ(percentile({}, 0.5), 0);
  EXPECT_EQ(mad(samples), 10);
}

TEST(MedianInterval, DegenerateSamples) {
  EXPECT_EQ(median_interval({}).high, 0);
  const std::vector<double> one = {3}, same = {2, 2, 2, 2};
  EXPECT_EQ(median_interval(one).low, 3);
  EXPECT_EQ(median_interval(one).high, 3);
  EXPECT_EQ(median_interval(same).low, 2);
  EXPECT_EQ(median_interval(same).high, 2);
}

// The lower middle of a resample is at most the k-th value when at least half of n draws are, rounded up, each with
// probability k/n; the upper one when one more than half are, rounded down. So the bootstrap's own distribution is
// known.
TEST(MedianInterval, HasTheRanksOfTheExactBootstrap) {
  for (const int n : {5, 8, 9, 12, 25, 41, 64}) {
    std::vector<double> samples;
    for (int i = 1; i <= n; ++i) samples.push_back(i);
    const auto at_most = [&](int k, int needed) {
      if (k == n) return 1.0;
      const double p = double(k) / n;
      double sum = 0;
      for (int draws = needed; draws <= n; ++draws)
        sum += std::exp(std::lgamma(n + 1) - std::lgamma(draws + 1) - std::lgamma(n - draws + 1) + draws * std::log(p) +
                        (n - draws) * std::log1p(-p));
      return sum;
    };
    const auto rank = [&](double fraction, int needed) {
      int k = 1;
      while (at_most(k, needed) < fraction) ++k;
      return k;
    };
    for (const double confidence : {0.95, 0.5}) {
      const Interval ci = median_interval(samples, {.confidence = confidence, .resamples = 40'000});
      EXPECT_EQ(ci.low, rank((1 - confidence) / 2, (n + 1) / 2)) << n << ", " << confidence;
      EXPECT_EQ(ci.high, rank((1 + confidence) / 2, n / 2 + 1)) << n << ", " << confidence;
    }
  }
}

TEST(MedianInterval, CoversTheMedianOfKnownDistributionsAsOftenAsItSays) {
  struct Known {
    const char* name;
    double median;
    std::function<double(double)> quantile;
  };
  const Known all[] = {{"uniform", 0.5, [](double u) { return u; }},
                       {"exponential", std::log(2.0), [](double u) { return -std::log1p(-u); }},
                       {"Cauchy", 0, [](double u) { return std::tan(std::numbers::pi * (u - 0.5)); }},
                       {"times with a tail", 10 + std::pow(0.5, 4), [](double u) { return 10 + std::pow(u, 4); }}};
  for (const Known& known : all) {
    Rng rng(7);
    int covered = 0;
    constexpr int trials = 600;
    for (int trial = 0; trial < trials; ++trial) {
      std::vector<double> samples(trial % 2 ? 25 : 12);
      for (double& s : samples) s = known.quantile(rng.uniform());
      const Interval ci = median_interval(samples, {.resamples = 400});
      covered += ci.low <= known.median && known.median <= ci.high;
    }
    EXPECT_GT(double(covered) / trials, 0.93) << known.name;
    EXPECT_LT(double(covered) / trials, 0.985) << known.name;
  }
}

TEST(MedianInterval, DependsOnTheValuesAndTheSeedAlone) {
  std::vector<double> samples;
  Rng rng(3);
  for (int i = 0; i < 31; ++i) samples.push_back(rng.uniform());
  const Interval first = median_interval(samples);
  std::reverse(samples.begin(), samples.end());
  std::swap(samples[3], samples[20]);
  const Interval again = median_interval(samples);
  EXPECT_EQ(first.low, again.low);
  EXPECT_EQ(first.high, again.high);
  EXPECT_LE(first.low, median(samples));
  EXPECT_GE(first.high, median(samples));
  // Few resamples: another seed draws others.
  const Interval other = median_interval(samples, {.resamples = 20, .seed = 2}),
                 same = median_interval(samples, {.resamples = 20, .seed = 3});
  EXPECT_TRUE(other.low != same.low || other.high != same.high);
}

}  // namespace
}  // namespace candela
