#include "bench/error_sweep.h"

#include "base/check.h"
#include "base/log.h"
#include "base/text.h"
#include "bench/measured.h"
#include "bench/picture.h"
#include "bench/scene_store.h"
#include "metrics/compare.h"
#include "metrics/flip.h"
#include "metrics/heatmap.h"
#include "render/outputs.h"
#include "render/plan_frame.h"
#include "render/reference_frame.h"

namespace candela {
namespace {

constexpr int strip_px = 960;

struct Truth {
  std::string name;
  FloatImage image;
  std::string failed;  // why there is none
};

// The scene's file in the configuration's job.
Expected<Job> job_with_file(const Configuration& c, SceneStore& store) {
  const auto file = store.file_of(c);
  if (!file) return std::unexpected(file.error());
  Job job = c.job;
  job.scene = *file;
  return job;
}

Expected<FloatImage> rendered(const Configuration& c, SceneStore& store, const RunSettings& settings) {
  const auto job = job_with_file(c, store);
  if (!job) return std::unexpected(job.error());
  const auto session = Session::open(*job, {.linear = true, .display = false}, settings);
  if (!session) return std::unexpected(session.error());
  const auto frame = (*session)->render(c.time_s);
  if (!frame) return std::unexpected(frame.error());
  NonFinite nonfinite;
  return linear_image(*frame, *job, **session, std::nullopt, FrameRate{}, nonfinite);
}

FloatImage traced(const ReferenceFrame& frame, const Job& job, const std::string& name, const ErrorSweepOptions& o,
                  const std::function<bool()>& stop) {
  reference::TraceSettings settings;
  settings.mode = name == "path" ? reference::Mode::path : reference::Mode::direct;
  settings.visibility = name != open_reference_name;
  reference::Film film(job.width_px, job.height_px);
  const reference::Integrator integrator(*frame.world, settings, film.width(), film.height());
  reference::refine(film, integrator, {.spp = o.reference_spp, .seconds = o.reference_s},
                    [&](const reference::Progress&) { return !stop || !stop(); });
  log::info("reference {}: {} samples a pixel, relative standard error {:.3g} %", name, film.samples(), film.relative_error() * 100);
  return reference_image(film, frame, job, settings_json(settings, {}), {"variance"}, std::nullopt, {});
}

std::vector<Truth> truths_of(const Configuration& c, SceneStore& store, const ErrorSweepOptions& o, const RunSettings& settings,
                             const std::function<bool()>& stop) {
  std::vector<Truth> truths;
  for (const std::string& name : error_reference_names()) truths.push_back({.name = name});
  Configuration exact = c;
  exact.job.technique = error_suites(o.base).front().techniques.front().name;
  exact.job.quality = "exact";
  exact.job.settings.clear();
  if (auto image = rendered(exact, store, settings))
    truths[0].image = std::move(*image);
  else
    truths[0].failed = image.error().text();
  const auto job = job_with_file(exact, store);
  using reference::Mode;
  const auto open = [&](Mode mode) { return job ? open_reference(*job, c.time_s, {}, mode) : std::unexpected(job.error()); };
  auto frame = open(Mode::direct);
  for (size_t i = 1; i < truths.size(); ++i) {
    // The last: paths go through what the others take as opaque.
    if (truths[i].name == "path" && frame && has_transmission((*frame)->scene)) frame = open(Mode::path);
    if (frame)
      truths[i].image = traced(**frame, *job, truths[i].name, o, stop);
    else
      truths[i].failed = frame.error().text();
  }
  return truths;
}

std::vector<std::byte> strip_of(const FloatImage& truth, const FloatImage& image, const Comparison& c) {
  if (c.flip_map.empty()) return {};
  return thumbnail_png(side_by_side(display_planes(truth, Encoding::linear), display_planes(image, Encoding::linear), c.flip_map, c.width, c.height),
                       strip_px);
}

void compare_with(const std::vector<Truth>& truths, const std::optional<ExposureRange>& exposures, const FloatImage& image, BenchRow& row) {
  for (const Truth& truth : truths) {
    PictureError error{.reference = truth.name, .note = truth.failed, .exposures = exposures};
    if (truth.failed.empty()) {
      Comparison c = compare(truth.image, image, {.encoding = Encoding::linear, .hdr_flip = HdrFlipChoice{exposures}});
      error.metrics = c.metrics;
      error.noise = c.noise;
      error.note = c.refusal;
      // Errors of a knob are seen against the exact picture, those of a whole technique against what it approximates.
      if (truth.name == (row.suite == "whole" ? open_reference_name : exact_reference)) row.strip = strip_of(truth.image, image, c);
    }
    row.errors.push_back(std::move(error));
  }
}

// Configurations of one place show the same scene from the same camera: they share their references.
std::string place_of(const Configuration& c) {
  return fmt::format("{}\n{}\n{}\n{}x{}\n{:a}\n{}", c.scene.label, c.seed, c.lights.value_or(-1), c.job.width_px, c.job.height_px, c.time_s,
                     c.scene.camera.camera);
}

}  // namespace

std::vector<std::string> error_reference_names() { return {exact_reference, open_reference_name, "direct", "path"}; }

std::vector<Suite> error_suites(const Suite& base) {
  std::vector<Suite> suites;
  Suite& whole = suites.emplace_back(base);
  whole.name = "whole";
  whole.set.clear();
  whole.qualities = {"draft", "normal", "high", "exact"};
  whole.samples = {0};
  if (whole.techniques.empty()) {
    // The job's own technique first: it is the one whose knobs are walked.
    const std::string first = Job{}.technique;
    whole.techniques.push_back({first, {}});
    for (const std::string& name : technique_names())
      if (name != first) whole.techniques.push_back({name, {}});
  }
  for (SuiteTechnique& technique : whole.techniques) technique.set.clear();
  for (const KnobRow& knob : knob_rows("exact")) {
    const std::vector<std::string> ladder = split(knob.ladder, ' ');
    if (ladder.size() < 2) continue;
    Suite& of_knob = suites.emplace_back(suites.front());
    of_knob.name = "knob " + knob.pass + "." + knob.knob;
    of_knob.qualities = {"exact"};
    of_knob.techniques.resize(1);
    of_knob.set = {{knob.pass, knob.knob, ladder}};
  }
  return suites;
}

Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings, const std::function<bool()>& stop) {
  const std::vector<Suite> suites = error_suites(options.base);
  std::vector<Configuration> all;
  for (const Suite& suite : suites) {
    auto some = configurations(suite);
    if (!some) return std::unexpected(some.error());
    all.insert(all.end(), some->begin(), some->end());
  }
  auto run = run_suites(suites, settings, stop);
  if (!run) return run;
  CHECK(run->rows.size() == all.size());  // one a configuration, in the same order
  SceneStore store;
  std::map<std::string, std::vector<size_t>> places;
  for (size_t i = 0; i < all.size(); ++i)
    if (!run->rows[i].frame.ms.empty()) places[place_of(all[i])].push_back(i);
  RunSettings untimed = settings;
  untimed.timed = false;
  for (const auto& [place, members] : places) {
    if (stop && stop()) break;
    const std::vector<Truth> truths = truths_of(all[members.front()], store, options, untimed, stop);
    std::optional<ExposureRange> exposures = options.exposures;
    for (const Truth& truth : truths)
      if (!exposures && truth.failed.empty() && truth.name == open_reference_name) {
        const auto plane = [&](const char* name) { return truth.image.find(name)->f; };
        exposures = automatic_exposures({plane("R"), plane("G"), plane("B")});
      }
    for (const size_t i : members) {
      const auto image = rendered(all[i], store, untimed);
      if (image)
        compare_with(truths, exposures, *image, run->rows[i]);
      else
        run->notes.push_back(row_title(run->rows[i]) + ": no picture to compare: " + image.error().text());
    }
  }
  return run;
}

}  // namespace candela
