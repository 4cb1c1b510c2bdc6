#include <gtest/gtest.h>

#include "bench/tune.h"

namespace candela {
namespace {

TuneTrial trial_of(std::vector<double> gpu_ms, std::vector<size_t> moments) {
  TuneTrial trial;
  trial.gpu_ms = std::move(gpu_ms), trial.moments = std::move(moments);
  return trial;
}

// Two settings of the same time, one measured while the device ran at a third of its clocks, and one that is twice as
// quick: what a search that believed its samples would order the other way round.
TEST(Tune, TimesAreThoseOfOneClock) {
  const std::vector<double> clock_ms = {6, 6.1, 6, 5.9, 2, 2, 2.1, 2, 2};
  std::vector<TuneTrial> trials = {trial_of({3, 3.1}, {1, 1}), trial_of({1, 1.02}, {6, 6}),
                                   trial_of({1.5, 1.5}, {2, 2}), trial_of({}, {})};
  const std::string note = settle_times(trials, clock_ms);
  EXPECT_NE(note.find("clocks or other load changed"), std::string::npos) << note;
  EXPECT_NEAR(trials[0].median_ms, trials[1].median_ms, 0.1);
  EXPECT_NEAR(trials[2].median_ms, trials[1].median_ms / 2, 0.05);
  EXPECT_EQ(trials[0].gpu_ms[0], 3) << "samples stay as they were taken";
  EXPECT_LT(trials[0].ms.low, trials[0].median_ms);
}

TEST(Tune, TimesStayWhereNoClockChanged) {
  std::vector<TuneTrial> trials = {trial_of({3, 3.2}, {0, 1})};
  // One outlier is no change.
  EXPECT_EQ(settle_times(trials, std::vector{2.0, 2.1, 2.0, 9.0, 2.1, 2.0}), "");
  EXPECT_NEAR(trials[0].median_ms, 3.1, 1e-12);
  EXPECT_EQ(settle_times(trials, {}), "");
}

}  // namespace
}  // namespace candela
