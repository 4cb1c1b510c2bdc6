#include <gtest/gtest.h>

#include "bench/error_analysis.h"
#include "bench/error_choice.h"
#include "bench/error_sweep.h"
#include "render/plan_frame.h"

namespace candela {
namespace {

BenchRow row_of(const std::string& suite, const std::string& technique, const std::string& quality, const std::string& settings, double ms,
                double own, double whole) {
  BenchRow row;
  row.suite = suite, row.scene = "street", row.technique = technique, row.quality = quality, row.settings = settings;
  row.width_px = 64, row.height_px = 32, row.device = "a device";
  row.gpu = {"gpu", {ms, ms, ms}}, row.frame = {"frame", {ms + 1, ms + 1, ms + 1}};
  Job job;
  job.technique = technique, job.quality = quality;
  if (!settings.empty()) job.settings = {*parse_knob_setting(settings)};
  row.job = job_json(job);
  row.errors = {{.reference = exact_reference, .metrics = {{"relmse", own}, {"rmse", std::sqrt(own)}}},
                {.reference = open_reference_name, .metrics = {{"relmse", whole}}, .noise = NoiseFloor{1e-3, 1e-5}}};
  return row;
}

// Two techniques, and a knob whose rmse is 0.3 * value: 1, 0.1, 0.01 and, exact, 0.
std::vector<BenchRow> sweep() {
  std::vector<BenchRow> rows = {row_of("whole", "clustered", "draft", "", 2, 0.1, 0.2), row_of("whole", "clustered", "exact", "", 6, 0, 0.01),
                                row_of("whole", "brute-force", "draft", "", 9, 0.1, 0.2), row_of("whole", "brute-force", "exact", "", 30, 0, 0.01)};
  for (const auto& [value, ms] : {std::pair(1.0, 3.0), std::pair(0.1, 4.0), std::pair(0.01, 5.0), std::pair(0.0, 6.0)})
    rows.push_back(row_of("knob lights.floor_lux", "clustered", "exact", fmt::format("lights.floor_lux={}", value), ms, 0.09 * value * value, 0.01 + value));
  return rows;
}
std::vector<const BenchRow*> pointers(const std::vector<BenchRow>& rows) {
  std::vector<const BenchRow*> all;
  for (const BenchRow& row : rows) all.push_back(&row);
  return all;
}

TEST(ErrorPoints, DominatedOnesAreKnown) {
  const auto rows = sweep();
  const auto all = pointers(rows);
  const auto points = error_points(std::span(all).first(4), open_reference_name, "relmse");
  ASSERT_EQ(points.size(), 4u);
  const std::vector<bool> dominated = {false, false, true, true};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(points[i].dominated, dominated[i]) << i;
  EXPECT_TRUE(error_points(all, "path", "relmse").empty());
}

TEST(ErrorSentences, NameTheCheapestAndTheNoise) {
  auto rows = sweep();
  const auto all = pointers(rows);
  const std::string sentence = cheapest_sentence(all, open_reference_name, "relmse", 0.05);
  EXPECT_NE(sentence.find("clustered, quality exact, lights.floor_lux=0.01: 5 ms"), std::string::npos) << sentence;
  EXPECT_EQ(cheapest_sentence(all, open_reference_name, "relmse", 1e-6), "no setting has relmse below 1e-06 against direct-unshadowed");
  rows[1].errors[1].metrics["relmse"] = 1e-6;
  EXPECT_NE(cheapest_sentence(all, open_reference_name, "relmse", 1e-4).find("below the reference's own noise"), std::string::npos);
  EXPECT_EQ(most_exact(all, open_reference_name, "relmse", 2.5), &rows[0]);
  EXPECT_EQ(most_exact(all, open_reference_name, "relmse", 1), nullptr);
}

TEST(KnobStudies, OrderOfConvergenceAndAdvice) {
  const auto rows = sweep();
  const auto studies = knob_studies(pointers(rows));
  ASSERT_EQ(studies.size(), 1u);
  const KnobStudy& study = studies[0];
  EXPECT_EQ(study.knob, "lights.floor_lux");
  ASSERT_EQ(study.values.size(), 4u);
  EXPECT_EQ(study.fit.points, 3u);  // the exact value has no error
  EXPECT_NEAR(study.fit.exponent, 1, 1e-9);
  EXPECT_NEAR(study.fit.factor, 0.3, 1e-9);
  EXPECT_NEAR(study.r_squared, 1, 1e-9);
  // The technique's own relmse is 0.01: 0.09 * 0.1^2 = 0.0009 is below a tenth of it, 0.09 is not.
  EXPECT_EQ(study.advised, "0.1");
  for (const auto& v : study.values) EXPECT_FALSE(v.dominated);
}

TEST(KnobStudies, AValueThatCostsMoreAndGivesLessIsDominated) {
  auto rows = sweep();
  rows[5].gpu.ms = {7, 7, 7};  // 0.1 is now slower than the exact value
  const auto studies = knob_studies(pointers(rows));
  EXPECT_TRUE(studies[0].values[1].dominated);
  EXPECT_NE(studies[0].values[1].verdict.find("no: "), std::string::npos);
  EXPECT_EQ(studies[0].advised, "0.01");
}

TEST(KnobStudies, AnIdleKnobIsSaidToBeIdleAndNoiseIsNotJudged) {
  auto rows = sweep();
  for (size_t i = 4; i < rows.size(); ++i) rows[i].errors[0].metrics["rmse"] = rows[i].errors[0].metrics["relmse"] = 0;
  const auto idle = knob_studies(pointers(rows))[0];
  EXPECT_EQ(idle.advised, "");
  EXPECT_EQ(idle.values[0].verdict, "changes nothing in this picture");
  // 0.01 took less time than 0 by far less than its own spread: neither dominates, and the exact one is advised.
  rows = sweep();
  rows[5].gpu.ms = {20, 20, 20};
  rows[6].gpu.ms = {4, 6, 8}, rows[7].gpu.ms = {5, 5.9, 7};
  rows[7].errors[0].metrics["relmse"] = 0.0008;  // both hidden
  const auto noisy = knob_studies(pointers(rows))[0];
  EXPECT_FALSE(noisy.values[2].dominated);
  EXPECT_EQ(noisy.advised, "0.01");
}

TEST(ErrorSentences, PreferAQualityToOneKnobOfIt) {
  auto rows = sweep();
  rows[7].gpu.ms = {5.9, 5.9, 6.3};  // floor 0 in quality exact is quality exact
  rows[7].errors = rows[1].errors;
  rows[6].errors[1].metrics["relmse"] = 1;
  rows[1].gpu.ms = {5.8, 6.0, 6.1};
  EXPECT_EQ(cheapest(pointers(rows), open_reference_name, "relmse", 0.05), &rows[1]);
}

TEST(KnobStudies, AnImperfectLawHasALowerRSquared) {
  auto rows = sweep();
  rows[5].errors[0].metrics["rmse"] = 0.2;
  const auto study = knob_studies(pointers(rows))[0];
  EXPECT_LT(study.r_squared, 0.95);
  EXPECT_GT(study.r_squared, 0.3);
}

TEST(ErrorSuites, WalkEveryLadderAndEveryQuality) {
  const auto suites = error_suites({});
  ASSERT_GE(suites.size(), 3u);
  EXPECT_EQ(suites[0].name, "whole");
  EXPECT_EQ(suites[0].qualities.size(), 4u);
  EXPECT_EQ(suites[0].techniques.size(), technique_names().size());
  EXPECT_EQ(suites[0].techniques[0].name, Job{}.technique);
  size_t ladders = 0;
  for (const KnobRow& knob : knob_rows("exact")) ladders += knob.ladder.find(' ') != std::string::npos;
  EXPECT_EQ(suites.size(), ladders + 1);
  for (const Suite& suite : std::span(suites).subspan(1)) {
    EXPECT_EQ(suite.qualities, std::vector<std::string>{"exact"});
    EXPECT_EQ(suite.techniques.size(), 1u);
    ASSERT_EQ(suite.set.size(), 1u);
    EXPECT_GE(suite.set[0].values.size(), 2u);
    Suite one = suite;
    one.scenes = {suite_scene("street", {}, {})};
    EXPECT_TRUE(configurations(one)) << suite.name;
  }
}

TEST(ErrorBudget, Parse) {
  ErrorBudget budget;
  ASSERT_TRUE(parse_error_budget("relMSE=0.01", budget));
  EXPECT_EQ(budget.metric, "relmse");
  EXPECT_EQ(budget.error, 0.01);
  for (const char* bad : {"relmse", "relmse=", "relmse=x", "relmse=-1", "psnr=30", "=1"}) EXPECT_FALSE(parse_error_budget(bad, budget)) << bad;
}

TEST(ChooseSetting, WorstPlaceCounts) {
  auto rows = sweep();
  // The same in another scene, where draft is slow and 0.01 leaves more error.
  for (BenchRow row : sweep()) {
    row.scene = "hall";
    if (row.quality == "draft") row.gpu.ms = {20, 20, 20};
    if (row.settings.ends_with("=0.01")) row.errors[1].metrics["relmse"] = 0.5;
    rows.push_back(row);
  }
  ErrorBudget budget{.error = 0.05};
  const auto exact = choose_setting(rows, 64, 32, budget, "f");
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->settings.size() + size_t(exact->quality == "exact"), exact->settings.empty() ? 1u : 2u);
  EXPECT_EQ(exact->ms, 6);
  budget.error = 1e-9;
  ASSERT_FALSE(choose_setting(rows, 64, 32, budget, "f"));
  EXPECT_EQ(choose_setting(rows, 64, 32, budget, "f").error().kind, ErrorKind::usage);
  const auto quick = choose_setting(rows, 64, 32, {.time_ms = 4.5}, "f");
  ASSERT_TRUE(quick);
  ASSERT_EQ(quick->settings.size(), 1u);
  EXPECT_EQ(quick->settings[0].value, "0.1");
  EXPECT_FALSE(choose_setting(rows, 64, 32, {.time_ms = 0.1}, "f"));
  const auto other_size = choose_setting(rows, 640, 320, budget, "f");
  ASSERT_FALSE(other_size);
  EXPECT_NE(other_size.error().message.find("64x32"), std::string::npos);
  EXPECT_EQ(choose_setting(rows, 64, 32, {.error = 1, .reference = "path"}, "f").error().kind, ErrorKind::input);
}

}  // namespace
}  // namespace candela
