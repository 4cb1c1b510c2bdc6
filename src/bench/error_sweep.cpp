#include "bench/error_sweep.h"

#include <map>

#include "base/log.h"
#include "bench/error_parts.h"
#include "bench/error_views.h"
#include "bench/error_walk.h"
#include "bench/measured.h"
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

// Compares the first frames of a place's rows, view by view.
class Judge {
 public:
  // truths: of each view.
  Judge(const SweepPlace& place, std::vector<std::vector<Truth>> truths, const std::optional<ExposureRange>& exposures)
      : place_(place),
        truths_(std::move(truths)),
        exposures_(exposures || truths_.empty() ? exposures : exposures_of(truths_.front())) {}

  void see(size_t item, BenchRow& row, const FrameResult& frame, const Session& session) {
    const SweepRow& planned = place_.rows[item];
    if (row_ != &row) start(row, planned);
    NonFinite nonfinite;
    FloatImage image = linear_image(frame, planned.configuration.job, session, std::nullopt, FrameRate{}, nonfinite);
    if (images_.empty() && planned.suite == "whole" && row.quality == "exact")
      row.thumbnail = thumbnail_png(
          as_display(display_planes(image, Encoding::linear), frame.width_px, frame.height_px), thumbnail_px);
    images_.push_back(std::move(image));
    if (images_.size() == place_.views.size()) finish(row, planned);
  }

 private:
  void start(BenchRow& row, const SweepRow& planned) {
    row_ = &row;
    images_.clear();
    row.knobs = planned.knobs;
    row.same_work = planned.same_work;
    row.lists_note = "not counted in sweeps of errors";
  }

  void finish(BenchRow& row, const SweepRow& planned) {
    if (planned.suite == "whole" && row.quality == "exact") exact_[row.technique] = images_;
    for (const SameWork& same : row.same_work)
      if (same.suite == "whole" && same.quality == "exact") exact_[same.technique] = images_;
    row.errors.push_back(error_of_exact(row.technique, row));
    for (SameWork& same : row.same_work)
      if (same.technique != row.technique) same.exact = error_of_exact(same.technique, row);
    for (size_t t = 0; !truths_.empty() && t < truths_.front().size(); ++t) {
      std::vector<PictureError> views;
      for (size_t view = 0; view < images_.size(); ++view) views.push_back(compared(truths_[view][t], view, row));
      row.errors.push_back(error_over(std::move(views)));
    }
    images_.clear();
  }

  PictureError error_of_exact(const std::string& technique, BenchRow& row) {
    const auto own = exact_.find(technique);
    std::vector<PictureError> views;
    for (size_t view = 0; view < images_.size(); ++view)
      views.push_back(compared(own == exact_.end()
                                   ? Truth{.name = exact_reference, .failed = "quality exact was not rendered"}
                                   : Truth{.name = exact_reference, .image = own->second[view]},
                               view, row));
    return error_over(std::move(views));
  }

  PictureError compared(const Truth& truth, size_t view, BenchRow& row) const {
    PictureError error{.reference = truth.name, .note = truth.failed, .exposures = exposures_, .spp = truth.spp};
    if (!truth.failed.empty()) return error;
    const FloatImage& image = images_[view];
    Comparison c = compare(truth.image, image, {.encoding = Encoding::linear, .hdr_flip = HdrFlipChoice{exposures_}});
    error.metrics = c.metrics;
    error.noise = c.noise;
    error.note = c.refusal;
    // Errors of a knob are seen against the exact picture, those of a whole technique against what it approximates.
    // Where there is nothing to see there is no strip.
    const bool differs = c.metrics.contains("differing") && c.metrics["differing"] > 0;
    if (view == 0 && differs && truth.name == (row.suite == "whole" ? open_reference_name : exact_reference))
      row.strip = strip_of(truth.image, image, c);
    return error;
  }

  const SweepPlace& place_;
  std::vector<std::vector<Truth>> truths_;
  std::optional<ExposureRange> exposures_;
  std::map<std::string, std::vector<FloatImage>> exact_;  // by technique, of each view
  const BenchRow* row_ = nullptr;                         // at hand
  std::vector<FloatImage> images_;                        // its views so far
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
  std::vector<std::vector<Truth>> truths;
  if (first.left_out.empty()) {
    if (const auto file = store.file_of(first)) {
      Job job = first.job;
      job.scene = *file;
      for (const BenchView& view : place.views) {
        job.camera = view.camera;
        truths.push_back(traced_truths(job, view.time_s, o.truth, stop));
      }
    }
  }
  Judge judge(place, truths, o.exposures);
  auto run = run_items(items, budget_s, settings, stop,
                       [&](size_t item, BenchRow& row, const FrameResult& frame, const Session& session) {
                         judge.see(item, row, frame, session);
                       });
  if (!run) return run;
  if (truths.empty()) return run;
  // Of whole techniques, in the first view: what a knob does to them its study says.
  std::vector<Job> jobs(run->rows.size());
  for (size_t i = 0; i < jobs.size(); ++i) {
    if (place.rows[i].suite != "whole" || run->rows[i].errors.empty()) continue;
    jobs[i] = place.rows[i].configuration.job;
    jobs[i].camera = place.views.front().camera;
    if (const auto file = store.file_of(place.rows[i].configuration)) jobs[i].scene = *file;
  }
  divide_errors(run->rows, jobs, place.views.front().time_s, truths.front(), settings, stop);
  return run;
}

}  // namespace

Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop) {
  SceneStore store;
  const auto places = sweep_places(options.base, store);
  if (!places) return std::unexpected(places.error());
  BenchRun all;
  int index = 0;
  for (const SweepPlace& place : *places) {
    auto run = run_place(place, options, options.base.budget_s / double(places->size()), store, settings, stop);
    if (!run) return run;
    for (const std::string& note : place.notes) log::info("{}", note);
    all.notes.insert(all.notes.end(), place.notes.begin(), place.notes.end());
    for (BenchRow& row : run->rows) {
      row.run = index;
      all.rows.push_back(std::move(row));
    }
    ++index;
    for (const std::string& note : run->notes)
      all.notes.push_back(place.rows.front().configuration.scene.label + ": " + note);
    all.wall_s += run->wall_s, all.opening_s += run->opening_s;
    all.stopped = all.stopped || run->stopped;
  }
  return all;
}

}  // namespace candela
