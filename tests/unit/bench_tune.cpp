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

// A reference of 10 ms a sample, whose 64 samples are wrong by 1e-4: 0.0064 over its samples.
TEST(Tune, SaysWhereTheReferenceIsTheQuickerTruth) {
  const auto setting = [](const char* options, double ms, double relmse) {
    TuneTrial t;
    t.options = options, t.median_ms = ms, t.ms = {ms * 0.99, ms * 1.01}, t.relmse = relmse, t.gpu_ms = {ms};
    return t;
  };
  TuneReport report;
  report.reference = "direct", report.reference_spp = 64, report.reference_ms = 10, report.noise = 1e-4;
  report.trials = {setting("--quality draft", 5, 0.1), setting("--quality normal", 20, 3e-3)};
  EXPECT_EQ(quicker_reference(report), "");  // three samples in 30 ms
  report.trials.push_back(setting("--quality exact", 500, 2e-4));
  const std::string note = quicker_reference(report);
  EXPECT_NE(note.find("32 samples a pixel"), std::string::npos) << note;
  EXPECT_NE(note.find("--quality exact and take 320 ms"), std::string::npos) << note;
  report.reference_ms = 0;
  EXPECT_EQ(quicker_reference(report), "");
}

}  // namespace
}  // namespace candela
