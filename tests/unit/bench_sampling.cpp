#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "bench/sampling.h"

namespace candela {
namespace {

TEST(Sampling, WarmUpEndsWhenThreeFramesAgreeOrAtALimit) {
  const SamplingRules rules{.max_warm_up = 6, .warm_up_s = 2};
  EXPECT_FALSE(warmed_up({}, rules));
  EXPECT_FALSE(warmed_up(std::vector{10.0, 10.0}, rules));
  EXPECT_FALSE(warmed_up(std::vector{30.0, 10.0, 10.1}, rules));
  EXPECT_TRUE(warmed_up(std::vector{30.0, 10.0, 10.1, 10.2}, rules));
  EXPECT_TRUE(warmed_up(std::vector{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, rules)) << "the limit on frames";
  EXPECT_TRUE(warmed_up(std::vector{2500.0}, rules)) << "the limit on time";
}

TEST(Sampling, ASteadyPilotNeedsNoMoreThanItself) {
  const SamplingRules rules{.precision = 0.01, .min_runs = 5, .max_runs = 64};
  const RunCount count = runs_needed(std::vector{10.0, 10.0, 10.01, 9.99, 10.0}, rules);
  EXPECT_EQ(count.runs, 5);
  EXPECT_FALSE(count.capped);
}

TEST(Sampling, TheNumberOfRunsFollowsFromTheSpread) {
  // MAD 0.2 of 10: sigma is 2.965 %, so 1 % of the median takes (1.2533 * 2.965)^2 = 13.8 runs.
  const std::vector<double> pilot = {9.8, 9.8, 10.0, 10.2, 10.2};
  EXPECT_EQ(runs_needed(pilot, {.precision = 0.01, .min_runs = 5, .max_runs = 64}).runs, 14);
  const RunCount capped = runs_needed(pilot, {.precision = 0.001, .min_runs = 5, .max_runs = 64});
  EXPECT_EQ(capped.runs, 64);
  EXPECT_TRUE(capped.capped);
}

TEST(Sampling, SummariesAreRobust) {
  const Summary s = summary(std::vector{1.0, 2.0, 3.0, 4.0, 1000.0});
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.mad, 1);
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.count, 5u);
  EXPECT_EQ(summary({}).count, 0u);
}

TEST(Sampling, EveryRoundHoldsAllInItsOwnOrder) {
  const std::vector<size_t> first = round_order(20, 1, 0), second = round_order(20, 1, 1);
  EXPECT_NE(first, second);
  EXPECT_EQ(first, round_order(20, 1, 0));
  for (std::vector<size_t> order : {first, second}) {
    std::sort(order.begin(), order.end());
    for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  }
  EXPECT_TRUE(round_order(0, 1, 0).empty());
}

TEST(Judge, OnlyWhatExceedsTheNoiseIsAChange) {
  const std::vector<double> steady = {10.0, 10.1, 9.9, 10.0, 10.0}, slower = {11.0, 11.1, 10.9, 11.0, 11.0};
  EXPECT_EQ(judge(steady, steady, {}).verdict, Verdict::same);
  EXPECT_EQ(judge(steady, slower, {}).verdict, Verdict::slower);
  EXPECT_EQ(judge(slower, steady, {}).verdict, Verdict::faster);
  EXPECT_NEAR(judge(steady, slower, {}).ratio(), 1.1, 1e-9);
  // The same shift of medians within a wide spread says nothing.
  const std::vector<double> noisy = {8.0, 9.0, 10.0, 11.0, 12.0}, noisy_slower = {9.0, 10.0, 11.0, 12.0, 13.0};
  EXPECT_EQ(judge(noisy, noisy_slower, {}).verdict, Verdict::same);
  // A sure change below the smallest that counts is none.
  const std::vector<double> barely = {10.3, 10.3, 10.3, 10.3, 10.3};
  EXPECT_EQ(judge(std::vector(5, 10.0), barely, {}).verdict, Verdict::same);
  EXPECT_EQ(judge(std::vector(5, 10.0), barely, {.min_relative = 0.01}).verdict, Verdict::slower);
}

TEST(Judge, TwoSamplesAreTooFew) {
  EXPECT_EQ(judge(std::vector{1.0, 1.0}, std::vector{9.0, 9.0, 9.0}, {}).verdict, Verdict::unclear);
}

TEST(PowerFit, FindsTheExponentOfItsRange) {
  std::vector<double> x, y;
  for (double n = 1; n <= 4096; n *= 4) x.push_back(n), y.push_back(3 * std::pow(n, 1.5));
  const PowerFit fit = fit_power(x, y);
  EXPECT_NEAR(fit.exponent, 1.5, 1e-12);
  EXPECT_NEAR(fit.factor, 3, 1e-9);
  EXPECT_EQ(fit.first_x, 1);
  EXPECT_EQ(fit.last_x, 4096);
  EXPECT_EQ(fit.points, x.size());
}

TEST(PowerFit, WhatHasNoLogarithmIsLeftOutAndOnePointIsNoLine) {
  const PowerFit fit = fit_power(std::vector{0.0, 2.0, 8.0}, std::vector{1.0, 2.0, 8.0});
  EXPECT_NEAR(fit.exponent, 1, 1e-12);
  EXPECT_EQ(fit.points, 2u);
  EXPECT_LT(fit_power(std::vector{0.0, 2.0}, std::vector{1.0, 2.0}).points, 2u);
  EXPECT_LT(fit_power(std::vector{2.0, 2.0}, std::vector{1.0, 2.0}).points, 2u) << "no range";
}

// Quantiles of Student's t, from the table of his distribution (Fisher 1925): 5 % on both sides.
TEST(StudentT, AgreesWithTheTable) {
  for (const auto& [degrees, t] : {std::pair(1.0, 12.7062), {4.0, 2.7764}, {7.0, 2.3646}, {30.0, 2.0423}})
    EXPECT_NEAR(student_two_sided(t, degrees), 0.05, 2e-5) << degrees;
  EXPECT_NEAR(student_two_sided(1.95996, 1e9), 0.05, 1e-5);
  EXPECT_NEAR(student_two_sided(-8.6103, 4), 0.001, 1e-6);
  EXPECT_EQ(student_two_sided(0, 5), 1);
  EXPECT_EQ(student_two_sided(INFINITY, 5), 0);
}

// Rows whose true times are known, measured in rounds: samples vary by 10 %, the machine drifts by 30 % over the run,
// and one sample in 30 takes three times as long.
class SyntheticRun {
 public:
  SyntheticRun(const std::vector<double>& true_ms, int rounds, uint64_t seed) : rng_(seed), ms_(true_ms.size()) {
    for (int round = 0; round < rounds; ++round)
      for (size_t row = 0; row < true_ms.size(); ++row) {
        const double drift = 1 + 0.3 * round / std::max(rounds - 1, 1), outlier = unit() < 1.0 / 30 ? 3 : 1;
        ms_[row].push_back(true_ms[row] * drift * outlier * std::exp(0.1 * normal()));
      }
  }
  const std::vector<double>& of(size_t row) const { return ms_[row]; }

 private:
  double unit() { return rng_.uniform(1e-12, 1); }
  double normal() { return std::sqrt(-2 * std::log(unit())) * std::cos(2 * std::numbers::pi * unit()); }
  Rng rng_;
  std::vector<std::vector<double>> ms_;
};

struct Sentences {
  int sure = 0, wrong = 0, twofold = 0, twofold_found = 0;
};
// "a takes less than b", of all pairs of rows.
Sentences sentences_of(const std::vector<double>& true_ms, const SyntheticRun& times) {
  std::vector<double> all;
  for (size_t a = 0; a < true_ms.size(); ++a)
    for (size_t b = 0; b < a; ++b) all.push_back(paired_order(times.of(a), times.of(b)).p);
  const double most_p = most_sure_p(all);
  Sentences s;
  for (size_t a = 0; a < true_ms.size(); ++a)
    for (size_t b = 0; b < true_ms.size(); ++b) {
      if (a == b) continue;
      const bool sure = paired_order(times.of(a), times.of(b), most_p).order == Order::less;
      const bool twofold = 2 * true_ms[a] <= true_ms[b];
      s.sure += sure, s.wrong += sure && true_ms[a] >= true_ms[b];
      s.twofold += twofold, s.twofold_found += sure && twofold;
    }
  return s;
}

// Where no two rows differ at most one run in twenty has a sure sentence; where some differ at most one sentence in
// twenty is false, and of twofold differences nine in ten are found with eight pairs.
TEST(DecidingOrder, FewSureSentencesAreFalseAndTwofoldDifferencesAreFound) {
  constexpr int runs = 400;
  const std::vector<double> equal(12, 5.0), some = {1, 1, 1.02, 1.02, 1.1, 1.3, 1.3, 1.6, 2, 2, 4, 9};
  for (const int rounds : {4, 6, 8, 12}) {
    int runs_with_sentence = 0;
    Sentences sum;
    for (int run = 0; run < runs; ++run) {
      const auto seed = uint64_t(1000 * rounds + run);
      runs_with_sentence += sentences_of(equal, SyntheticRun(equal, rounds, seed)).sure > 0;
      const Sentences s = sentences_of(some, SyntheticRun(some, rounds, seed));
      sum.sure += s.sure, sum.wrong += s.wrong, sum.twofold += s.twofold, sum.twofold_found += s.twofold_found;
    }
    EXPECT_LE(runs_with_sentence, runs / 20) << rounds << " rounds";
    EXPECT_LE(sum.wrong, sum.sure / 20) << rounds << " rounds, " << sum.sure << " sentences";
    if (rounds >= 8) EXPECT_GE(sum.twofold_found, sum.twofold * 9 / 10) << rounds << " rounds";
  }
}

// With fewer pairs than a test takes, the noise of the whole run decides.
TEST(DecidingOrder, FewSamplesAreJudgedByTheNoiseOfTheRun) {
  const std::vector<double> a = {5, 5.2}, twice = {10, 10.4}, near = {5.6, 5.7};
  const TimeNoise noise{.samples = 0.1, .moments = 0.05, .degrees = 30};
  EXPECT_EQ(paired_order(a, twice).order, Order::unclear) << "two pairs";
  EXPECT_EQ(order_of_samples(a, twice, noise).order, Order::less);
  EXPECT_EQ(order_of_samples(twice, a, noise).order, Order::greater);
  EXPECT_EQ(order_of_samples(a, near, noise).order, Order::unclear);
  EXPECT_EQ(order_of_samples(a, twice, {.samples = 0.8, .moments = 0.05, .degrees = 30}).order, Order::unclear);
  EXPECT_EQ(order_of_samples(a, {}, noise).order, Order::unclear);
  int wrong = 0, found = 0;
  for (int run = 0; run < 1000; ++run) {
    const SyntheticRun times({5, 5, 10}, 2, uint64_t(run));
    wrong += order_of_samples(times.of(0), times.of(1), noise).order != Order::unclear;
    found += order_of_samples(times.of(0), times.of(2), noise).order == Order::less;
  }
  EXPECT_LE(wrong, 50);
  EXPECT_GE(found, 900);
}

// An interval of two samples is not their range: in a thousand runs it holds the true time in at least 95 %.
TEST(DecidingOrder, IntervalsOfFewSamplesHoldTheMedian) {
  const TimeNoise noise{.samples = 0.1, .moments = 0.05, .degrees = 30};
  for (const int rounds : {1, 2, 3, 5}) {
    int held = 0;
    for (int run = 0; run < 1000; ++run) {
      const SyntheticRun times({5}, rounds, uint64_t(run));
      const double drifted = 5 * (rounds == 1 ? 1 : 1.15);
      const Interval ci = time_interval(times.of(0), noise);
      held += ci.low <= drifted && drifted <= ci.high;
    }
    EXPECT_GE(held, 950) << rounds;
  }
  const std::vector<double> many = {5, 6, 5, 6, 5, 6};
  EXPECT_EQ(time_interval(many, noise).low, median_interval(many).low);
  EXPECT_EQ(time_interval({}, noise).high, 0);
  for (const double p : {0.5, 0.05, 0.001}) EXPECT_NEAR(student_two_sided(student_quantile(p, 7), 7), p, 1e-9);
}

TEST(DecidingOrder, PairsThatAreEqualAreEqual) {
  const std::vector<double> a = {1, 2, 3, 4};
  EXPECT_EQ(paired_order(a, a).order, Order::equal);
  EXPECT_EQ(paired_order(std::vector{0.0, 0.0, 0.0, 0.0}, a).order, Order::less) << "where a value has no logarithm";
  EXPECT_EQ(paired_order(std::vector{1.0, 2.0, 3.0}, std::vector{4.0, 5.0, 6.0}).order, Order::unclear);
}

}  // namespace
}  // namespace candela
