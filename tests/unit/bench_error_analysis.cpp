#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "base/text.h"
#include "bench/error_analysis.h"
#include "bench/error_choice.h"
#include "bench/error_truth.h"
#include "bench/error_views.h"
#include "bench/scene_store.h"
#include "bench/sweep_places.h"
#include "gltf/gltf.h"
#include "job/frame_knobs.h"
#include "job/job_look.h"
#include "plan/plan_frame.h"

namespace candela::bench_error_analysis {
namespace {

BenchRow row_of(const std::string& suite, const std::string& technique, const std::string& quality,
                const std::string& settings, double ms, double own, double whole) {
  BenchRow row;
  row.suite = suite, row.scene = "street", row.technique = technique, row.quality = quality, row.settings = settings;
  row.width_px = 64, row.height_px = 32, row.device = "a device", row.scene_content = "content of " + row.scene;
  const auto six = [](double v) { return std::vector<double>(6, v); };
  row.passes = {{"light_sort", six(ms / 4)}, {"shade_forward", six(ms / 2)}, {"tonemap", six(9)}};
  row.memory = {{"frame_bytes", 1 << 20}};
  row.gpu = {"gpu", six(ms)}, row.frame = {"frame", six(ms + 1)};
  Job job;
  job.technique = technique, job.quality = quality;
  if (!settings.empty()) {
    job.settings = {*parse_knob_setting(settings)};
    row.knobs = {{suite.substr(5), job.settings[0].value, "error", {"light_sort", "shade_forward"}}};
  }
  row.job = job_json(job);
  row.errors = {{.reference = exact_reference, .metrics = {{"relmse", own}, {"rmse", std::sqrt(own)}}},
                {.reference = open_reference_name, .metrics = {{"relmse", whole}}, .noise = NoiseFloor{1e-3, 1e-5}}};
  return row;
}

// Two techniques, and a knob whose rmse is 0.3 * value: 1, 0.1, 0.01 and, exact, 0.
std::vector<BenchRow> sweep() {
  std::vector<BenchRow> rows = {row_of("whole", "clustered", "draft", "", 2, 0.1, 0.2),
                                row_of("whole", "clustered", "exact", "", 6, 0, 0.01),
                                row_of("whole", "brute-force", "draft", "", 9, 0.1, 0.2),
                                row_of("whole", "brute-force", "exact", "", 30, 0, 0.01)};
  // The exact end of the knob is the technique's.
  rows[1].knobs = {{"lights.floor_lux", "0", "error", {"light_sort", "shade_forward"}}};
  for (const auto& [value, ms] : {std::pair(1.0, 3.0), std::pair(0.1, 4.0), std::pair(0.01, 5.0)})
    rows.push_back(row_of("knob lights.floor_lux", "clustered", "exact", fmt::format("lights.floor_lux={}", value), ms,
                          0.09 * value * value, 0.01 + value));
  return rows;
}
std::vector<const BenchRow*> pointers(const std::vector<BenchRow>& rows) {
  std::vector<const BenchRow*> all;
  for (const BenchRow& row : rows) all.push_back(&row);
  return all;
}

const BudgetPlace here{
    .scene = "street.glb", .scene_content = "content of street", .width_px = 64, .height_px = 32, .device = "a device"};

TEST(ErrorPoints, DominatedOnesAreKnown) {
  const auto rows = sweep();
  const auto all = pointers(rows);
  const auto points = error_points(std::span(all).first(4), open_reference_name, "relmse");
  ASSERT_EQ(points.size(), 4u);
  const std::vector<bool> dominated = {false, false, true, true};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(points[i].standing == ErrorPoint::Standing::dominated, dominated[i]) << i;
  EXPECT_EQ(points[2].by, &rows[0]);
  EXPECT_TRUE(error_points(all, "path", "relmse").empty());
}

TEST(ErrorSentences, NameTheCheapestAndTheNoise) {
  auto rows = sweep();
  const auto all = pointers(rows);
  const std::string sentence = cheapest_sentence(all, open_reference_name, "relmse", 0.05);
  EXPECT_NE(sentence.find("clustered, quality exact, lights.floor_lux=0.01: 5 ms"), std::string::npos) << sentence;
  EXPECT_TRUE(cheapest_sentence(all, open_reference_name, "relmse", 1e-6)
                  .starts_with("no setting surely has relmse below 1e-06 against direct-unshadowed: clustered, quality "
                               "exact has 0.01"));
  EXPECT_EQ(cheapest_sentence(all, "path", "relmse", 1), "") << "no sentence without data";
  auto unmeasured = sweep();
  for (BenchRow& row : unmeasured) row.gpu.ms.clear();
  EXPECT_EQ(cheapest_sentence(pointers(unmeasured), open_reference_name, "relmse", 1), "");
  rows[1].errors[1].metrics["relmse"] = 1e-6;
  EXPECT_NE(cheapest_sentence(all, open_reference_name, "relmse", 1e-4).find("below the reference's own noise"),
            std::string::npos);
}

TEST(KnobStudies, OrderOfConvergenceAndAdvice) {
  const auto rows = sweep();
  const auto studies = knob_studies(pointers(rows));
  ASSERT_EQ(studies.size(), 1u);
  const KnobStudy& study = studies[0];
  EXPECT_EQ(study.knob, "lights.floor_lux");
  EXPECT_EQ(study.technique, "clustered");
  ASSERT_EQ(study.values.size(), 4u);
  EXPECT_EQ(study.values[3].row, &rows[1]);
  EXPECT_EQ(study.values[0].ms, 3);
  EXPECT_DOUBLE_EQ(study.values[0].passes_ms, 2.25) << "of the passes that the knob belongs to";
  EXPECT_EQ(study.fit.points, 3u);  // the exact value has no error
  EXPECT_NEAR(study.fit.exponent, 1, 1e-9);
  EXPECT_NEAR(study.fit.factor, 0.3, 1e-9);
  EXPECT_NEAR(study.r_squared, 1, 1e-9);
  // The technique's own relmse is 0.01: 0.09 * 0.1^2 = 0.0009 is below a tenth of it, 0.09 is not.
  EXPECT_EQ(study.advised, "0.1");
  for (const auto& v : study.values) EXPECT_FALSE(v.dominated);
}

TEST(KnobStudies, AFireflyOfTheTechniqueHidesNothing) {
  auto rows = sweep();
  rows[1].errors[1].metrics["relmse-trimmed"] = 0.001;  // all but one pixel
  EXPECT_EQ(knob_studies(pointers(rows))[0].advised, "0.01")
      << "0.0009 of 0.1 is no longer a tenth of what is wrong elsewhere";
}

TEST(KnobStudies, AValueThatCostsMoreAndGivesLessIsDominated) {
  auto rows = sweep();
  rows[5].gpu.ms = {7, 7, 7, 7, 7, 7};  // 0.1 is now slower than the exact value
  const auto studies = knob_studies(pointers(rows));
  EXPECT_TRUE(studies[0].values[1].dominated);
  EXPECT_NE(studies[0].values[1].verdict.find("no: "), std::string::npos);
  EXPECT_EQ(studies[0].advised, "0.01");
}

TEST(KnobStudies, AnIdleKnobIsSaidToBeIdleAndNoiseIsNotJudged) {
  auto rows = sweep();
  for (size_t i = 4; i < rows.size(); ++i) rows[i].errors[0].metrics["rmse"] = rows[i].errors[0].metrics["relmse"] = 0;
  ASSERT_EQ(rows.size(), 7u);
  const auto idle = knob_studies(pointers(rows))[0];
  EXPECT_EQ(idle.advised, "");
  EXPECT_EQ(idle.values[0].verdict, "changes nothing in this picture");
  // 0.01 took less time than 0 by far less than its own spread: neither dominates, and the exact one is advised.
  rows = sweep();
  rows[5].gpu.ms = {20, 20, 20, 20, 20, 20};
  rows[6].gpu.ms = {4, 6, 8, 4, 6, 8}, rows[1].gpu.ms = {5, 5.9, 7, 5, 5.9, 7};
  rows[1].errors[0].metrics["relmse"] = 0.0008;  // both hidden
  const auto noisy = knob_studies(pointers(rows))[0];
  EXPECT_FALSE(noisy.values[2].dominated);
  EXPECT_EQ(noisy.advised, "0.01");
}

const BenchRow* cheapest_row(const std::vector<BenchRow>& rows, double most) {
  const auto all = pointers(rows);
  const auto settings = setting_points(all, open_reference_name, "relmse");
  const SettingPoint* found = cheapest(settings, most);
  return found ? found->row : nullptr;
}

TEST(ErrorSentences, PreferAQualityToOneKnobOfIt) {
  auto rows = sweep();
  rows[6].gpu.ms = {5.9, 5.9, 6.3, 5.9, 5.9, 6.3};  // a knob that changes nothing but the name
  rows[6].errors = rows[1].errors;
  rows[1].gpu.ms = {5.8, 6.0, 6.1, 5.8, 6.0, 6.1};
  EXPECT_EQ(cheapest_row(rows, 0.05), &rows[1]);
  // Of several such qualities the quickest.
  rows[2].errors = rows[1].errors;
  rows[2].gpu.ms = {5.8, 6.2, 6.3, 5.8, 6.2, 6.3};
  EXPECT_EQ(cheapest_row(rows, 0.05), &rows[1]);
  rows[2].gpu.ms = {5.8, 5.95, 6.3, 5.8, 5.95, 6.3};
  EXPECT_EQ(cheapest_row(rows, 0.05), &rows[2]);
}

// One function chooses for the report and for a render.
TEST(ChooseSetting, AgreesWithTheReportsSentence) {
  auto rows = sweep();
  rows[6].gpu.ms = {5.9, 5.9, 6.3, 5.9, 5.9, 6.3};
  rows[6].errors = rows[1].errors;
  rows[1].gpu.ms = {5.8, 6.0, 6.1, 5.8, 6.0, 6.1};
  for (const double bound : {1.0, 0.3, 0.05, 0.015}) {
    const auto choice = choose_setting(rows, here, {.error = bound}, "f");
    ASSERT_TRUE(choice) << choice.error().text();
    const std::string sentence = cheapest_sentence(pointers(rows), open_reference_name, "relmse", bound);
    EXPECT_NE(sentence.find("the cheapest setting is " + choice->text + ": "), std::string::npos) << sentence << "\n"
                                                                                                  << choice->text;
  }
}

TEST(ErrorPoints, WhatIsNotSurelyQuickerIsNotDistinguishable) {
  auto rows = sweep();
  // Both vary by far more than they differ; the second is slower in every round.
  rows[0].gpu.ms = {2, 9, 3, 8, 4, 7};
  rows[2].gpu.ms = {2.1, 9.1, 3.1, 8.1, 4.1, 7.1};
  using Standing = ErrorPoint::Standing;
  const auto all = pointers(rows);
  const auto standing = [&](size_t i) {
    return error_points(std::span(all).first(3), open_reference_name, "relmse")[i].standing;
  };
  EXPECT_EQ(standing(2), Standing::dominated) << "pairs of rounds tell them apart";
  rows[2].gpu.ms = {9.1, 2.1, 8.1, 3.1, 7.1, 4.1};
  EXPECT_EQ(standing(2), Standing::unclear);
  EXPECT_EQ(standing(0), Standing::front);
  rows[0].gpu.ms = {2, 9, 3}, rows[2].gpu.ms = {2.1, 9.1, 3.1};
  EXPECT_EQ(standing(2), Standing::unclear) << "three pairs are too few, and the run's noise is larger";
  rows[0].gpu.ms = {2, 9, 3, 8, 4, 7}, rows[2].gpu.ms = {2.1, 9.1, 3.1, 8.1, 4.1, 7.1}, rows[2].run = 1;
  EXPECT_EQ(standing(2), Standing::unclear) << "rounds of another run are no pairs";
}

// Two samples whose ranges do not meet are no proof, of the same run or of another.
TEST(ErrorPoints, AFewSamplesOfOtherRunsAreNotTakenForSure) {
  auto rows = sweep();
  rows[0].gpu.ms = {2, 2.02}, rows[2].gpu.ms = {2.1, 2.13}, rows[2].run = 1;
  const auto all = pointers(rows);
  EXPECT_NE(order_of_times(rows[0], rows[2]).order, Order::less);
  EXPECT_EQ(error_points(std::span(all).first(3), open_reference_name, "relmse")[2].standing,
            ErrorPoint::Standing::unclear);
  rows[2].gpu.ms = {9, 9.1};
  EXPECT_EQ(order_of_times(rows[0], rows[2]).order, Order::less);
}

// Six views: error i + shift.
PictureError of_views(double shift, double odd = 0) {
  std::vector<PictureError> views;
  for (int i = 0; i < 6; ++i)
    views.push_back({.reference = open_reference_name,
                     .metrics = {{"relmse", 0.01 * i + (i % 2 ? odd : 0) + shift}, {"max", double(i)}, {"rmse", 3}},
                     .noise = NoiseFloor{3, 0.001, 0.0002}});
  return error_over(std::move(views));
}

TEST(ErrorViews, MeansAndIntervals) {
  const PictureError error = of_views(0.1);
  EXPECT_NEAR(error.metrics.at("relmse"), 0.125, 1e-12);
  EXPECT_EQ(error.metrics.at("max"), 5);
  EXPECT_NEAR(error.metrics.at("rmse"), 3, 1e-12);
  EXPECT_EQ(error.views.size(), 6u);
  ASSERT_TRUE(error.noise);
  EXPECT_NEAR(error.noise->relmse_sd, 0.0002 / std::sqrt(6.0), 1e-12);
  // The spread of 0, 1, ... 5 is sqrt(3.5); t of 5 degrees of freedom 2.571; and the floor of 0.001 below.
  const double half = 2.571 * 0.01 * std::sqrt(3.5 / 6);
  const Interval ci = error_interval(error, "relmse");
  EXPECT_NEAR(ci.low, 0.125 - half - 0.001, 1e-6);
  EXPECT_NEAR(ci.high, 0.125 + half, 1e-6);
  EXPECT_EQ(error_interval(of_views(0, 0.5), "relmse").low, 0) << "no error is negative";
  // Of one view nothing but its noise is known.
  const PictureError one{.reference = "direct", .metrics = {{"relmse", 0.5}}, .noise = NoiseFloor{1, 0.01, 0.1}};
  EXPECT_NEAR(error_interval(one, "relmse").low, 0.5 - 0.196 - 0.01, 1e-4);
  EXPECT_NEAR(error_interval(one, "relmse").high, 0.696, 1e-4);
}

TEST(ErrorViews, WorseIsDecidedOnPairsOfViews) {
  BenchRow a, b;
  a.errors = {of_views(0.1)}, b.errors = {of_views(0.104)};
  EXPECT_EQ(order_of_errors(a, b, open_reference_name, "relmse").order, Order::less) << "less in every view";
  b.errors = {of_views(0.102)};
  EXPECT_EQ(order_of_errors(a, b, open_reference_name, "relmse").order, Order::unclear)
      << "less than three times the noise";
  b.errors = {of_views(0.1, 0.005)};
  EXPECT_EQ(order_of_errors(a, b, open_reference_name, "relmse").order, Order::unclear) << "the same in half of them";
  EXPECT_EQ(order_of_errors(a, a, open_reference_name, "relmse").order, Order::equal);
  EXPECT_EQ(order_of_errors(a, b, "path", "relmse").order, Order::unclear);
}

TEST(RowsByName, WhatPlansTheSameWorkHasItsOwnName) {
  auto rows = sweep();
  rows.erase(rows.begin() + 3);
  PictureError own{.reference = exact_reference, .metrics = {{"relmse", 0.125}, {"rmse", 0.25}}};
  rows[1].same_work = {{"whole", "brute-force", "exact", "", rows[1].job, rows[1].knobs, own}};
  EXPECT_EQ(error_names(rows[1]), "clustered, quality exact = brute-force, quality exact");
  const auto named = rows_by_name(pointers(rows));
  ASSERT_EQ(named.size(), rows.size() + 1);
  EXPECT_EQ(named[2].technique, "brute-force");
  EXPECT_EQ(named[2].gpu.ms, rows[1].gpu.ms);
  EXPECT_EQ(error_of(named[2], exact_reference, "relmse"), 0.125);
  EXPECT_EQ(total_errors(pointers(named), open_reference_name).size(), 4u);
}

TEST(UnsweptKnobs, AreNamedWithTheReason) {
  const auto rows = sweep();
  const std::vector<std::string> unswept = unswept_knobs(rows);
  const std::string all = joined(unswept);
  EXPECT_EQ(all.find("lights.floor_lux"), std::string::npos) << all;
  EXPECT_NE(all.find("lights.cap (its passes run; no row differs in it)"), std::string::npos) << all;
  auto idle = sweep();
  for (BenchRow& row : idle) row.passes.clear();
  EXPECT_NE(joined(unswept_knobs(idle)).find("resolve.samples (no row has its passes)"), std::string::npos);
}

TEST(KnobStudies, OfTimeAlone) {
  auto rows = sweep();
  for (size_t i = 4; i < rows.size(); ++i) {
    rows[i].errors[0].metrics = {{"relmse", 0}, {"rmse", 0}, {"differing", 0}};
    rows[i].knobs[0].kind = "time";
  }
  rows[1].knobs[0].kind = "time";
  auto study = knob_studies(pointers(rows))[0];
  EXPECT_EQ(study.advised, "1") << "the quickest";
  EXPECT_EQ(study.values[3].verdict, "no: 1 is quicker and no worse");
  for (const size_t i : {4, 5, 6}) rows[i].gpu.ms = {5, 6.1, 7, 5, 6.1, 7};
  EXPECT_EQ(knob_studies(pointers(rows))[0].advised, "0") << "nothing is quicker beyond doubt";
  EXPECT_TRUE(error_defects(pointers(rows)).empty());
  rows[5].errors[0].metrics["differing"] = 1;
  const auto defects = error_defects(pointers(rows));
  ASSERT_EQ(defects.size(), 1u);
  EXPECT_NE(defects[0].find("clustered: lights.floor_lux=0.1 must change nothing but time, and 1 pixels differ"),
            std::string::npos)
      << defects[0];
  // Beside another setting it is the picture of that one.
  rows[5].settings = "lights.floor_lux=0.1 local.method=maps";
  EXPECT_EQ(error_defects(pointers(rows)).size(), 1u) << "that setting alone was not measured";
  rows.push_back(rows[5]);
  rows.back().settings = "local.method=maps", rows.back().knobs[0] = {"local.method", "maps", "error", {}};
  EXPECT_TRUE(error_defects(pointers(rows)).empty());
  rows.back().errors[0].metrics["rmse"] = 1e-9;
  EXPECT_EQ(error_defects(pointers(rows)).size(), 1u);
  rows[5].knobs[0].kind = "error";
  EXPECT_TRUE(error_defects(pointers(rows)).empty());
}

TEST(TotalErrors, ModelAndSampling) {
  const auto rows = sweep();
  const auto totals = total_errors(pointers(rows), open_reference_name);
  ASSERT_EQ(totals.size(), 4u);
  EXPECT_EQ(totals[0].total, 0.2);
  EXPECT_EQ(totals[0].model, 0.01);
  EXPECT_EQ(totals[0].sampling, 0.1);
  EXPECT_EQ(totals[1].total, totals[1].model);
  EXPECT_EQ(totals[1].sampling, 0);
  EXPECT_TRUE(total_errors(pointers(rows), "path").empty());
}

TEST(NoiseVerdicts, ATenthOfTheSmallestError) {
  auto rows = sweep();
  auto verdicts = noise_verdicts(pointers(rows));
  ASSERT_EQ(verdicts.size(), 1u);
  EXPECT_TRUE(verdicts[0].enough);
  EXPECT_EQ(verdicts[0].smallest, 0.01);
  rows[3].errors[1].metrics["relmse"] = 0.99e-4;
  verdicts = noise_verdicts(pointers(rows));
  EXPECT_FALSE(verdicts[0].enough);
  EXPECT_NE(verdicts[0].sentence.find("--reference-spp"), std::string::npos);
}

TEST(KnobStudies, AnImperfectLawHasALowerRSquared) {
  auto rows = sweep();
  rows[5].errors[0].metrics["rmse"] = 0.2;
  const auto study = knob_studies(pointers(rows))[0];
  EXPECT_LT(study.r_squared, 0.95);
  EXPECT_GT(study.r_squared, 0.3);
}

TEST(Knobs, SweepsEndAtTheExactValue) {
  for (const KnobRow& knob : knob_rows("exact")) {
    const std::string name = knob.pass + "." + knob.knob;
    if (knob.kind == "look") continue;
    EXPECT_GE(knob.sweep.size(), 2u) << name << " is swept by nobody";
    EXPECT_EQ(knob.sweep.back(), knob.value_now) << name;
    EXPECT_FALSE(knob.passes.empty()) << name;
    for (const std::string& value : knob.sweep) {
      Job job;
      job.quality = "exact";
      job.settings = {{knob.pass, knob.knob, value}};
      EXPECT_TRUE(frame_knobs(job)) << name << "=" << value;
    }
  }
}

struct Swept {
  // "clustered lights.test=aabb"; what plans the same work as a row; knobs whose study the technique's exact end
  // belongs to.
  std::set<std::string> rows, same, exact;
  std::string notes;
};
Swept swept(const SweepPlace& place) {
  Swept w;
  for (const SweepRow& row : place.rows) {
    const Job& job = row.configuration.job;
    EXPECT_EQ(row.configuration.views.size(), place.views.size());
    for (const SameWork& same : row.same_work) {
      w.same.insert(same.technique + " " + (same.settings.empty() ? same.quality : same.settings));
      for (const KnobPoint& point : same.knobs)
        if (same.suite == "whole") w.exact.insert(same.technique + " " + point.knob);
    }
    EXPECT_EQ(row.suite == "whole", job.settings.empty());
    if (row.suite == "whole") {
      EXPECT_EQ(row.knobs.empty(), job.quality != "exact");
      for (const KnobPoint& point : row.knobs) w.exact.insert(job.technique + " " + point.knob);
      continue;
    }
    EXPECT_EQ(job.quality, "exact");
    EXPECT_EQ(row.knobs.size(), 1u);
    EXPECT_TRUE(w.rows.insert(job.technique + " " + settings_text(job)).second) << settings_text(job);
  }
  for (const std::string& note : place.notes) w.notes += note + "\n";
  return w;
}

TEST(SweepPlaces, SweepEveryKnobOfAnyPass) {
  Suite base;
  base.scenes = {suite_scene("light-field", {}, {})};
  base.lights = {64};
  base.techniques = {{"clustered", {}}, {"forward-plus", {}}, {"brute-force", {}}};
  base.sizes = {{160, 90}};
  base.view_count = 2;  // each one more is as many plans again
  base.qualities = {"draft"};
  SceneStore store;
  const auto places = sweep_places(base, store);
  ASSERT_TRUE(places) << places.error().text();
  ASSERT_EQ(places->size(), 1u);
  const SweepPlace& place = places->front();
  std::vector<std::string> qualities;
  for (const SweepRow& row : place.rows)
    if (row.suite == "whole" && row.configuration.job.technique == Job{}.technique)
      qualities.push_back(row.configuration.job.quality);
  EXPECT_EQ(qualities, (std::vector<std::string>{"exact", "draft", "normal", "high"}))
      << "the exact end first: others are compared with it";
  const Swept w = swept(place);
  for (const char* row :
       {"clustered lights.test=aabb", "clustered lights.list=compact", "clustered cull.enabled=0",
        "clustered lights.floor_lux=0.1", "clustered lights.tile_px=8", "forward-plus lights.test=cone-sphere",
        "forward-plus lights.mask=0", "brute-force resolve.samples=1 supersample.n=1", "brute-force lights.floor_lux=1",
        "clustered lights.cap=4"})
    EXPECT_TRUE(w.rows.contains(row) || w.same.contains(row)) << row;
  for (const std::string& name : w.same) EXPECT_FALSE(w.rows.contains(name)) << name << " is measured twice";
  EXPECT_EQ(place.views.size(), 2u);
  EXPECT_EQ(Suite{}.view_count, 6);
  // What plans the same work is measured once, as the technique's exact end.
  for (const char* row :
       {"brute-force lights.test=aabb", "brute-force lights.cap=4", "forward-plus lights.tile_px=8",
        "clustered lights.mask=0", "clustered lights.floor_lux=0", "clustered lights.test=capsule-joint"})
    EXPECT_FALSE(w.rows.contains(row)) << row;
  EXPECT_NE(w.notes.find("lights.tile_px,"), std::string::npos) << w.notes;
  EXPECT_EQ(w.notes.find("lights.tile_px="), std::string::npos) << w.notes;
  EXPECT_TRUE(w.exact.contains("clustered lights.tile_px"));
  EXPECT_FALSE(w.exact.contains("forward-plus lights.tile_px"));
}

// What a pass does in a plan, without the numbers of its resources.
std::string declared(const FramePlan& plan, const PlanPass& pass) {
  FramePlan alone;
  alone.passes = {pass};
  for (PlanUse& use : alone.passes[0].uses) use.resource = use.version = 0;
  for (size_t i = 0; i < pass.pipelines.size(); ++i) {
    alone.pipelines.push_back(plan.pipelines[size_t(pass.pipelines[i])]);
    alone.passes[0].pipelines[i] = int(i);
  }
  alone.passes[0].name = std::string(pass.pass());
  return plan_hash(alone).hex();
}
// By pass: what its instances do.
std::map<std::string, std::set<std::string>> declared(const FramePlan& plan) {
  std::map<std::string, std::set<std::string>> all;
  for (const PlanPass& pass : plan.passes) all[std::string(pass.pass())].insert(declared(plan, pass));
  return all;
}

// In a note that tells why it is not swept; not by the frame having none of its passes, which is said of what a table
// leaves out too.
bool is_named(const SweepPlace& place, const std::string& technique, const std::string& knob) {
  return std::ranges::any_of(place.notes, [&](const std::string& note) {
    return note.find(" with " + technique + ":") != std::string::npos && note.find(knob) != std::string::npos &&
           note.find("none of their passes") == std::string::npos;
  });
}

// A scene and a look with a sun, a lamp, a sky, fog, see-through surfaces, reflections and occlusion.
SuiteScene scene_with_all(const std::filesystem::path& folder) {
  SuiteScene scene = suite_scene("stained", {}, {});
  scene.look = {"all", (folder / "all.look.json").string()};
  std::ofstream(scene.look.file) << R"({"sky": {"gradient": {"zenith": [0.1, 0.2, 0.6], "horizon": [1.2, 0.9, 0.6],
      "ground": 0.1, "exponent": 0.6}}, "fog": {"extinction": 0.03}, "reflections": {}, "occlusion": {"radius_m": 0.6},
      "bloom": {"strength": 0.3}})";
  return scene;
}

// Of what a sweep holds: a value that changes a plan changes some pass of it, which follows the knob's table, and so
// the knob is swept. The techniques whose whole sweep is planned here have all passes between them.
TEST(SweepPlaces, WhatChangesThePlanIsSweptAndChangesPassesThatFollowTheTable) {
  Suite base;
  const std::filesystem::path folder = testing::TempDir();
  base.scenes = {scene_with_all(folder)};
  base.techniques = {{"visibility", {}}, {"deferred-volumes", {}}};
  base.sizes = {{32, 18}};
  base.view_count = 1;
  SceneStore store;
  const auto places = sweep_places(base, store);
  ASSERT_TRUE(places) << places.error().text();
  const SweepPlace& place = places->front();
  const Swept w = swept(place);
  for (const char* knob : {"ibl.method", "occlusion.method", "occlusion.slices", "lights.floor_lux", "resolve.samples"})
    EXPECT_TRUE(w.exact.contains(std::string("visibility ") + knob)) << knob;
  const Configuration& any = place.rows.front().configuration;
  const auto file = store.file_of(any);
  ASSERT_TRUE(file);
  const auto scene = load_gltf(*file);
  ASSERT_TRUE(scene);
  const auto layout = layout_geometry(*scene);
  ASSERT_TRUE(layout);
  Job job = any.job;
  job.scene = *file;
  std::vector<std::string> warnings;
  const auto look = look_of(job, 0);
  ASSERT_TRUE(look);
  const auto sky = JobSky::read(job, *look, *scene, warnings);
  ASSERT_TRUE(sky);
  job.quality = "high";  // a plan of it is smaller
  const auto planned = [&](const KnobRow& knob, const std::string& value) {
    job.settings = {{knob.pass, knob.knob, value}};
    for (const std::string& setting : knob.required) job.settings.push_back(*parse_knob_setting(setting));
    const auto frame = plan_frame(job, {*scene, *layout, &*sky}, {}, 0);
    EXPECT_TRUE(frame) << settings_text(job) << ": " << frame.error().text();
    return frame ? frame->graph().plan : FramePlan{};
  };
  for (const std::string& technique : technique_names()) {
    job.technique = technique;
    const bool sweeps = std::ranges::find(base.techniques, technique, &SuiteTechnique::name) != base.techniques.end();
    for (const KnobRow& knob : knob_rows("exact")) {
      if (knob.kind == "look") continue;
      const std::string name = knob.pass + "." + knob.knob;
      const FramePlan one = planned(knob, knob.sweep.front()), other = planned(knob, knob.sweep.back());
      auto of_one = declared(one), of_other = declared(other);
      for (const std::string& pass : pass_names()) {
        const bool listed = std::ranges::find(knob.passes, pass) != knob.passes.end();
        EXPECT_TRUE(listed || of_one[pass] == of_other[pass])
            << technique << ": " << name << " changes " << pass << ", which follows no table that has it";
      }
      if (sweeps && plan_hash(one) != plan_hash(other)) {
        EXPECT_TRUE(w.exact.contains(technique + " " + name) || is_named(place, technique, name))
            << technique << ": " << name << " is not swept";
      }
    }
  }
}

TEST(SweepPlaces, ASceneThatIsNotThereStaysInTheList) {
  Suite base;
  base.scenes = {suite_scene("absent.glb", {}, {})};
  base.sizes = {{160, 90}, {32, 32}};
  base.techniques = {{"clustered", {}}};
  SceneStore store;
  const auto places = sweep_places(base, store);
  ASSERT_TRUE(places);
  ASSERT_EQ(places->size(), 2u);
  EXPECT_EQ((*places)[0].rows.size(), 4u);
  ASSERT_EQ((*places)[0].notes.size(), 1u);
  EXPECT_NE((*places)[0].notes[0].find("no knob was swept"), std::string::npos);
}

TEST(ErrorBudget, Parse) {
  ErrorBudget budget;
  ASSERT_TRUE(parse_error_budget("relMSE=0.01", budget));
  EXPECT_EQ(budget.metric, "relmse");
  EXPECT_EQ(budget.error, 0.01);
  for (const char* bad : {"relmse", "relmse=", "relmse=x", "relmse=-1", "psnr=30", "=1"})
    EXPECT_FALSE(parse_error_budget(bad, budget)) << bad;
}

TEST(ChooseSetting, TheWorstOfItsTimesCounts) {
  auto rows = sweep();
  // The same at another moment, where draft is slow and 0.01 leaves more error.
  for (BenchRow row : sweep()) {
    row.time_s = 1;
    if (row.quality == "draft") row.gpu.ms = {20, 20, 20, 20, 20, 20};
    if (row.settings.ends_with("=0.01")) row.errors[1].metrics["relmse"] = 0.5;
    rows.push_back(row);
  }
  ErrorBudget budget{.error = 0.05};
  const auto exact = choose_setting(rows, here, budget, "f");
  ASSERT_TRUE(exact);
  EXPECT_TRUE(exact->settings.empty());
  EXPECT_EQ(exact->quality, "exact");
  EXPECT_EQ(exact->ms, 6);
  budget.error = 1e-9;
  ASSERT_FALSE(choose_setting(rows, here, budget, "f"));
  EXPECT_EQ(choose_setting(rows, here, budget, "f").error().kind, ErrorKind::usage);
  const auto quick = choose_setting(rows, here, {.time_ms = 4.5}, "f");
  ASSERT_TRUE(quick);
  ASSERT_EQ(quick->settings.size(), 1u);
  EXPECT_EQ(quick->settings[0].value, "0.1");
  EXPECT_FALSE(choose_setting(rows, here, {.time_ms = 0.1}, "f"));
}

TEST(ChooseSetting, ATimeBudgetHoldsForTheEndOfTheInterval) {
  auto rows = sweep();
  rows[5].gpu.ms = {4, 4, 4, 4.1, 4.6, 4.8, 4.9};  // 0.1: median 4.1, but not surely below 4.5
  const auto choice = choose_setting(rows, here, {.time_ms = 4.5}, "f");
  ASSERT_TRUE(choice) << choice.error().text();
  ASSERT_EQ(choice->quality, "draft") << choice->text;
  const auto wide = choose_setting(rows, here, {.time_ms = 4.95}, "f");
  ASSERT_TRUE(wide);
  ASSERT_EQ(wide->settings.size(), 1u);
  EXPECT_EQ(wide->ms, 4.1);
  EXPECT_GT(wide->ms_ci.high, 4.5);
  EXPECT_LE(wide->ms_ci.high, 4.95);
  const auto none = choose_setting(rows, here, {.time_ms = 1.5}, "f");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("95 % CI"), std::string::npos) << none.error().message;
}

TEST(ChooseSetting, OtherPlacesAreRefused) {
  const auto rows = sweep();
  const auto refusal = [&](BudgetPlace place) {
    const auto choice = choose_setting(rows, place, {.error = 0.05}, "sweep.json");
    EXPECT_FALSE(choice);
    return choice ? std::string() : choice.error().kind == ErrorKind::input ? choice.error().text() : "not input";
  };
  BudgetPlace place = here;
  place.width_px = 640;
  EXPECT_NE(refusal(place).find("at 640x32 but at 64x32"), std::string::npos) << refusal(place);
  place = here, place.device = "another device";
  EXPECT_NE(refusal(place).find("on another device but on a device"), std::string::npos) << refusal(place);
  place = here, place.scene_content = "more", place.scene = "hall.glb";
  EXPECT_NE(refusal(place).find("with the content of hall.glb but with street"), std::string::npos) << refusal(place);
  EXPECT_EQ(choose_setting(rows, here, {.error = 1, .reference = "path"}, "f").error().kind, ErrorKind::input);
}

}  // namespace
}  // namespace candela::bench_error_analysis
