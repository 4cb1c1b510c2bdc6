#include "bench/error_sweep.h"

#include <map>

#include "base/log.h"
#include "bench/error_walk.h"
#include "bench/picture.h"
#include "metrics/compare.h"
#include "metrics/flip.h"
#include "metrics/heatmap.h"
#include "render/outputs.h"

namespace candela {
namespace {

constexpr int strip_px = 960;

std::vector<std::byte> strip_of(const FloatImage& truth, const FloatImage& image, const Comparison& c) {
  if (c.flip_map.empty()) return {};
  return thumbnail_png(side_by_side(display_planes(truth, Encoding::linear), display_planes(image, Encoding::linear),
                                    c.flip_map, c.width, c.height),
                       strip_px);
}

// Exposures of the place, so that hdr-flip means the same in all of its rows.
std::optional<ExposureRange> exposures_of(const std::vector<Truth>& truths) {
  for (const Truth& truth : truths)
    if (truth.failed.empty() && truth.name == open_reference_name) {
      const auto plane = [&](const char* name) { return truth.image.find(name)->f; };
      return automatic_exposures({plane("R"), plane("G"), plane("B")});
    }
  return {};
}

// Compares the first frames of a place's rows.
class Judge {
 public:
  Judge(const SweepPlace& place, std::vector<Truth> truths, const std::optional<ExposureRange>& exposures)
      : place_(place), truths_(std::move(truths)), exposures_(exposures ? exposures : exposures_of(truths_)) {}

  void see(size_t item, BenchRow& row, const FrameResult& frame, const Session& session) {
    const SweepRow& planned = place_.rows[item];
    row.knobs = planned.knobs;
    row.lists_note = "not counted in sweeps of errors";
    NonFinite nonfinite;
    const FloatImage image =
        linear_image(frame, planned.configuration.job, session, std::nullopt, FrameRate{}, nonfinite);
    if (planned.suite == "whole" && row.quality == "exact")
      exact_[row.technique] = {.name = exact_reference, .image = image};
    const auto own = exact_.find(row.technique);
    compare_with(
        own == exact_.end() ? Truth{.name = exact_reference, .failed = "quality exact was not rendered"} : own->second,
        image, row);
    for (const Truth& truth : truths_) compare_with(truth, image, row);
  }

 private:
  void compare_with(const Truth& truth, const FloatImage& image, BenchRow& row) const {
    PictureError error{.reference = truth.name, .note = truth.failed, .exposures = exposures_, .spp = truth.spp};
    if (truth.failed.empty()) {
      Comparison c = compare(truth.image, image, {.encoding = Encoding::linear, .hdr_flip = HdrFlipChoice{exposures_}});
      error.metrics = c.metrics;
      error.noise = c.noise;
      error.note = c.refusal;
      // Errors of a knob are seen against the exact picture, those of a whole technique against what it approximates.
      // Where there is nothing to see there is no strip.
      const bool differs = c.metrics.contains("differing") && c.metrics["differing"] > 0;
      if (differs && truth.name == (row.suite == "whole" ? open_reference_name : exact_reference))
        row.strip = strip_of(truth.image, image, c);
    }
    row.errors.push_back(std::move(error));
  }

  const SweepPlace& place_;
  std::vector<Truth> truths_;
  std::optional<ExposureRange> exposures_;
  std::map<std::string, Truth> exact_;  // by technique
};

Expected<BenchRun> run_place(const SweepPlace& place, const ErrorSweepOptions& o, double budget_s, SceneStore& store,
                             const RunSettings& settings, const std::function<bool()>& stop) {
  std::map<std::string, Suite> suites;
  std::vector<RunItem> items;
  for (const SweepRow& row : place.rows) {
    const auto [suite, made] = suites.try_emplace(row.suite, o.base);
    suite->second.name = row.suite;
    if (suite->second.output == "png") suite->second.output = "both";
    items.push_back({&suite->second, row.configuration});
  }
  const Configuration& first = place.rows.front().configuration;
  std::vector<Truth> truths;
  if (first.left_out.empty()) {
    if (const auto file = store.file_of(first)) {
      Job job = first.job;
      job.scene = *file;
      truths = traced_truths(job, first.time_s, o.truth, stop);
    }
  }
  Judge judge(place, std::move(truths), o.exposures);
  return run_items(items, budget_s, settings, stop,
                   [&](size_t item, BenchRow& row, const FrameResult& frame, const Session& session) {
                     judge.see(item, row, frame, session);
                   });
}

}  // namespace

Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop) {
  SceneStore store;
  const auto places = sweep_places(options.base, store);
  if (!places) return std::unexpected(places.error());
  BenchRun all;
  for (const SweepPlace& place : *places) {
    auto run = run_place(place, options, options.base.budget_s / double(places->size()), store, settings, stop);
    if (!run) return run;
    for (const std::string& note : place.notes) log::info("{}", note);
    all.notes.insert(all.notes.end(), place.notes.begin(), place.notes.end());
    std::move(run->rows.begin(), run->rows.end(), std::back_inserter(all.rows));
    for (const std::string& note : run->notes)
      all.notes.push_back(place.rows.front().configuration.scene.label + ": " + note);
    all.wall_s += run->wall_s;
  }
  return all;
}

}  // namespace candela
