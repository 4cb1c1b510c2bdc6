#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace candela
