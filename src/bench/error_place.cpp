#include "bench/error_place.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/log.h"
#include "bench/deadline.h"
#include "bench/error_analysis.h"
#include "bench/error_judge.h"
#include "bench/error_parts.h"
#include "bench/error_screen.h"
#include "bench/error_views.h"
#include "bench/measured.h"
#include "bench/sweep_places.h"
#include "bench/sweep_rows.h"
#include "metrics/compare.h"
#include "render/outputs.h"

namespace candela {
namespace {

// Errors are of linear pictures.
Suite linear_too(Suite suite) {
  if (suite.output == "png") suite.output = "both";
  return suite;
}

class PlaceRun {
 public:
  // place: planned by sweep_places(), or, with a budget, the rows of suite "whole" alone, which nothing has planned.
  PlaceRun(SweepPlace place, const ErrorSweepOptions& options, double budget_s, SceneStore& store,
           const RunSettings& settings, const std::function<bool()>& stop,
           std::function<void(const std::vector<BenchRow>&)> progress)
      : place_(std::move(place)),
        options_(options),
        settings_(settings),
        store_(store),
        time_(budget_s, stop),
        first_(place_.rows.front().configuration),
        suite_(linear_too(options.base)),
        rows_(suite_, settings, time_, std::move(progress)) {
    settings_.timed = true;
  }

  Expected<BenchRun> run() {
    if (!first_.left_out.empty()) {
      for (SweepRow& row : place_.rows) rows_.add_unmeasured(row, claimed_).left_out = first_.left_out;
      return finish();
    }
    announce();
    if (auto opened = open(); !opened) {
      for (SweepRow& row : place_.rows) {
        BenchRow& failed = rows_.add_unmeasured(row, claimed_);
        failed.error = opened.error().text(), failed.error_kind = int(opened.error().kind);
      }
      log::error("{}: {}", first_.scene.label, opened.error().text());
      return finish();
    }
    if (time_.over()) {
      note("opening took {:.3g} s: nothing was measured in the {:g} s of --budget-s; give at least {:.0f} s",
           time_.elapsed_s(), time_.budget_s(), std::ceil(4 * time_.elapsed_s()));
      return finish();
    }
    trace();
    if (time_.limited())
      measure_by_use();
    else
      measure_all();
    rows_.sample_rounds(claimed_);
    return finish();
  }

 private:
  template <class... A>
  void note(fmt::format_string<A...> format, A&&... a) {
    notes_.push_back(fmt::format(format, std::forward<A>(a)...));
    log::info("{}: {}", first_.scene.label, notes_.back());
  }

  // Before anything is opened: what will be done and how long that is.
  void announce() const {
    const std::string what = fmt::format("{}, {}x{}", first_.scene.label, first_.job.width_px, first_.job.height_px);
    if (time_.limited())
      log::info(
          "{}: error against time in {:.3g} s, opening and traced reference included: the qualities of {}, then its "
          "knobs that carry error, then other techniques, until the time is over",
          what, time_.budget_s(), first_.job.technique);
    else
      log::info("{}: error against time of {} settings in {} views, without a limit (--budget-s)", what,
                place_.rows.size(), place_.views.size());
  }

  Expected<void> open() {
    const auto file = store_.file_of(first_);
    if (!file) return std::unexpected(file.error());
    job_ = first_.job;
    job_.scene = *file;
    if (time_.limited()) job_.quality = "high";
    auto session = Session::open(job_, {.linear = true, .display = suite_.output == "both"}, settings_);
    if (!session) return std::unexpected(session.error());
    session_ = std::move(*session);
    rows_.attach(*session_);
    claimed_ = claimed_reference(job_, session_->scene());
    return time_.limited() ? choose_views() : Expected<void>();
  }

  // Six where that leaves time for two dozen rows, four where it does not, else one: errors in fewer than four views
  // are no pairs.
  Expected<void> choose_views() {
    const double before = time_.elapsed_s();
    const auto frame = session_->render(first_.time_s);
    if (!frame) return std::unexpected(frame.error());
    opening_s_ = time_.elapsed_s();
    const auto again = session_->render(first_.time_s);
    if (!again) return std::unexpected(again.error());
    const double first_s = opening_s_ - before, frame_s = time_.elapsed_s() - opening_s_;
    NonFinite nonfinite;
    const FloatImage image = linear_image(*again, job_, *session_, std::nullopt, FrameRate{}, nonfinite);
    const double comparing_s = time_.elapsed_s();
    compare(image, image, {.encoding = Encoding::linear});
    const double compare_s = time_.elapsed_s() - comparing_s;
    constexpr double rows = 24, frames = 4;
    const double each_s = 0.5 * time_.left_s() / rows - first_s;
    int count = 1;
    for (int views = int(least_pairs); views <= suite_.view_count; ++views)
      if (views * (frames * frame_s + compare_s) <= each_s) count = views;
    // An earlier run chose already, whatever time this one has.
    const auto kept = kept_row(options_.kept, rows_.named_row(place_.rows.front()), *session_, true);
    if (!kept) return std::unexpected(kept.error());
    if (*kept) count = (*kept)->views;
    place_.views = {{job_.camera, first_.time_s}};
    log::info("{}: opened in {:.3g} s; a frame of {}, quality high takes {:.3g} s; {} view{}", first_.scene.label,
              opening_s_, job_.technique, frame_s, count, count == 1 ? "" : "s");
    if (!suite_.views.empty()) {
      place_.views.assign(suite_.views.begin(), suite_.views.begin() + std::min(count, int(suite_.views.size())));
    } else if (auto views = views_around(session_->scene(), job_, first_.time_s, count)) {
      place_.views = std::move(*views);
    } else {
      note("one view: {}", views.error().text());
    }
    const int asked = suite_.views.empty() ? suite_.view_count : int(suite_.views.size());
    if (count < asked) note("{} of {} views: more do not fit the time", count, asked);
    if (int(place_.views.size()) < std::min(count, asked)) note("one view: the camera is orthographic and stands");
    return {};
  }

  void trace() {
    TruthLimits limits = options_.truth;
    std::vector<std::string> names;
    if (time_.limited()) {
      // A fifth of the time, or until its noise is below what errors differ by.
      names = {claimed_};
      const double fraction = 0.2 * time_.left_s() / double(place_.views.size());
      limits.spp = std::max<uint64_t>(limits.spp, 4096), limits.noise = 1e-5;
      limits.seconds = limits.seconds > 0 ? std::min(limits.seconds, fraction) : fraction;
      limits.with_parts = false;
    } else {
      for (const std::string& name : error_reference_names())
        if (name != exact_reference) names.push_back(name);
    }
    std::vector<TruthView> views;
    for (const BenchView& view : place_.views) views.push_back({view.camera, view.time_s});
    judge_.emplace(traced_truths(job_, views, names, limits, [&] { return time_.over(); }), claimed_,
                   options_.exposures, !time_.limited());
    for (const Truth& truth : judge_->truths().front())
      if (!truth.failed.empty()) note("no errors against {}: {}", truth.name, truth.failed);
  }

  // Without a budget: rows that sweep_places() has planned.
  void measure_all() {
    size_t done = 0;
    const double start_s = time_.elapsed_s();
    for (SweepRow& row : place_.rows) {
      if (time_.over()) {
        rows_.add_unmeasured(row, claimed_).error = "the run was stopped before this was measured";
        continue;
      }
      row.configuration.views = place_.views;
      if (!is_kept(row)) rows_.measure(std::move(row), *judge_);
      ++done;
      // Opening, and the rounds until each has its least number of samples.
      double visits_s = 0;
      for (const OpenRow& open : rows_.all()) visits_s += open.visit_s;
      const double opening_s = (time_.elapsed_s() - start_s) / double(done);
      const double all = double(place_.rows.size());
      log::info("{} of {} settings; about {:.0f} s left", done, place_.rows.size(),
                opening_s * (all - double(done)) + visits_s / double(done) * all * suite_.sampling.min_runs);
    }
    divide();
  }

  void measure_by_use() {
    const std::string own = first_.job.technique;
    const auto whole = [&](const std::string& technique, const std::string& quality) {
      const auto found = std::ranges::find_if(place_.rows, [&](const SweepRow& row) {
        return row.configuration.job.technique == technique && row.configuration.job.quality == quality;
      });
      if (found != place_.rows.end()) consider(*found);
    };
    for (const char* quality : {"high", "draft", "normal"}) whole(own, quality);
    consider_steps();
    std::vector<std::string> techniques;
    for (const SweepRow& row : place_.rows)
      if (std::ranges::find(techniques, row.configuration.job.technique) == techniques.end())
        techniques.push_back(row.configuration.job.technique);
    for (const char* quality : {"high", "draft", "normal"})
      for (const std::string& technique : techniques)
        if (technique != own) whole(technique, quality);
    for (const std::string& technique : techniques) whole(technique, "exact");
    if (!time_.stopped() && time_.left_s() > 0) consider_sweeps(own);
    if (left_ + rows_.interrupted() > 0)
      note("{} settings were not measured: the time was over (--budget-s)", left_ + rows_.interrupted());
    if (dear_ > 0) note("{} settings were not measured: each would have taken more than the time that was left", dear_);
  }

  // Knobs a step from quality high; those that carry most error in small pictures first.
  void consider_steps() {
    if (time_.over()) return;
    constexpr int divisor = 4;
    const Job small = divided_size(job_, divisor);
    const double limit_s = time_.elapsed_s() + 0.25 * time_.left_s();
    const auto truths = traced_truths(small, {{place_.views[0].camera, place_.views[0].time_s}}, {claimed_},
                                      {.spp = 256, .seconds = 0.05 * time_.left_s(), .with_parts = false},
                                      [&] { return time_.over(); });
    const Truth& truth = truths.front().front();
    if (!truth.failed.empty()) return;
    session_->set_camera(place_.views[0].camera);
    const auto screen = screen_knobs(
        *session_,
        {.base = job_, .time_s = place_.views[0].time_s, .divisor = divisor, .truth = &truth.image, .knobs = {}},
        [&] { return time_.over() || time_.elapsed_s() > limit_s; });
    rows_.forget_visit();
    if (!screen) return;
    log::info("{}: {} knob settings were tried in pictures of {}x{}{}", first_.scene.label, screen->tried,
              small.width_px, small.height_px, screen->left > 0 ? fmt::format(", {} not", screen->left) : "");
    for (const ScreenedStep& step : screen->steps) {
      Configuration c = first_;
      c.job.quality = "high", c.job.settings = {step.setting};
      // A frame has as many more pixels; what is dear at full size waits until others have had their turn.
      const double more_s = (step.ms - screen->ms) / 1000 * divisor * divisor * visit_frames();
      const std::string name = "step " + step.setting.pass + "." + step.setting.knob;
      consider({name, std::move(c), {}, {}}, rows_.typical_s() + std::max(more_s, 0.0), 0.2);
    }
  }

  void consider_sweeps(const std::string& technique) {
    const auto exact = std::ranges::find_if(rows_.all(), [&](const OpenRow& row) {
      return row.planned.suite == "whole" && row.measured->row.quality == "exact" &&
             row.measured->row.technique == technique && row.measured->can_sample();
    });
    if (exact == rows_.all().end()) return;
    for (const KnobRow& knob : knob_rows("exact")) {
      if (knob.kind == "look" || knob.sweep.size() < 2) continue;
      const std::string name = knob.pass + "." + knob.knob;
      const size_t before = rows_.all().size();
      for (const std::string& value : knob.sweep) {
        if (value == knob.value_now && knob.required.empty()) continue;
        Configuration c = exact->planned.configuration;
        c.job.settings = {{knob.pass, knob.knob, value}};
        for (const std::string& setting : knob.required) c.job.settings.push_back(*parse_knob_setting(setting));
        consider({"knob " + name, std::move(c), {{name, value, knob.kind, knob.passes}}, {}});
      }
      if (rows_.all().size() > before)
        exact->measured->row.knobs.push_back({name, knob.value_now, knob.kind, knob.passes});
    }
  }

  // Measures what is no other row's work, where its time, if it is known, fits that fraction of what is left.
  void consider(SweepRow row, std::optional<double> needs_s = {}, double fraction = 1) {
    if (time_.over()) {
      ++left_;
      return;
    }
    row.configuration.views = place_.views;
    Job job = row.configuration.job;
    if (auto set = session_->set_settings(job); !set) {
      note("{}, quality {}: {}", job.technique, job.quality, set.error().text());
      return;
    }
    rows_.forget_visit();
    std::string works;
    for (const BenchView& view : place_.views) {
      session_->set_camera(view.camera);
      const auto work = session_->work(view.time_s);
      if (!work) {
        note("{}, quality {}: {}", job.technique, job.quality, work.error().text());
        return;
      }
      works += work->hash.hex();
    }
    if (const auto found = works_.find(hash128(works)); found != works_.end()) {
      if (found->second) judge_->see_same(row, found->second->measured->row);
      return;
    }
    if (is_kept(row)) {
      works_.emplace(hash128(works), nullptr);
      return;
    }
    if ((needs_s ? *needs_s : estimated_s(job)) > fraction * time_.left_s()) {
      ++dear_;
      return;
    }
    if (OpenRow* open = rows_.measure(std::move(row), *judge_)) works_.emplace(hash128(works), open);
  }

  // Of a row before it is opened. The exact end, and what is a step from it, is known by a picture of an eighth of the
  // size.
  double estimated_s(const Job& job) {
    if (job.quality != "exact") return 0.5 * rows_.typical_s();
    if (exact_frame_s_ <= 0) {
      constexpr int divisor = 8;
      const auto small = picture_in(*session_, divided_size(job, divisor), place_.views[0].time_s, 1);
      if (!small) return INFINITY;
      exact_frame_s_ = small->ms / 1000 * divisor * divisor;
    }
    return exact_frame_s_ * visit_frames();
  }
  // Frames of a row until it has two samples.
  double visit_frames() const { return 1 + 3 * double(place_.views.size()); }

  bool is_kept(const SweepRow& row) {
    const auto kept = kept_row(options_.kept, rows_.named_row(row), *session_);
    if (kept && *kept) log::info("{}: kept from before", error_setting(**kept));
    return kept && *kept;
  }

  // Whole techniques in the first view: what a knob does to them its study says.
  void divide() {
    if (judge_->truths().empty() || time_.stopped()) return;
    std::vector<BenchRow> rows;
    std::vector<Job> jobs;
    for (OpenRow& open : rows_.all()) {
      rows.push_back(open.measured->row);
      Job& job = jobs.emplace_back();
      if (open.planned.suite != "whole" || rows.back().errors.empty()) continue;
      job = open.planned.configuration.job;
      job.camera = place_.views.front().camera, job.scene = job_.scene;
    }
    divide_errors(rows, jobs, place_.views.front().time_s, judge_->truths().front(), settings_,
                  [&] { return time_.stopped(); });
    size_t i = 0;
    for (OpenRow& open : rows_.all()) open.measured->row.errors = std::move(rows[i++].errors);
  }

  Expected<BenchRun> finish() {
    BenchRun run;
    for (OpenRow& row : rows_.all()) row.measured->finish();
    run.rows = rows_.so_far();
    std::vector<const BenchRow*> own;
    for (OpenRow& row : rows_.all()) own.push_back(&row.measured->row);
    if (std::string change = clock_change(own); !change.empty()) notes_.push_back(std::move(change));
    run.notes = place_.notes;
    run.notes.insert(run.notes.end(), notes_.begin(), notes_.end());
    run.wall_s = time_.elapsed_s(), run.opening_s = opening_s_;
    run.stopped = time_.stopped();
    if (run.stopped) run.notes.emplace_back("the run was stopped before its end");
    return run;
  }

  SweepPlace place_;
  const ErrorSweepOptions& options_;
  RunSettings settings_;
  SceneStore& store_;
  Deadline time_;
  Configuration first_;
  Suite suite_;
  Job job_;  // with the scene's file
  std::string claimed_;
  std::unique_ptr<Session> session_;
  std::optional<ErrorJudge> judge_;
  SweepRows rows_;
  std::map<Hash128, OpenRow*> works_;  // null: an earlier run measured it
  double opening_s_ = 0, exact_frame_s_ = 0;
  int left_ = 0, dear_ = 0;  // rows not measured: the time was over; it would not have been enough
  std::vector<std::string> notes_;
};

}  // namespace

Expected<BenchRun> run_error_place(SweepPlace place, const ErrorSweepOptions& options, double budget_s,
                                   SceneStore& store, const RunSettings& settings, const std::function<bool()>& stop,
                                   const std::function<void(const std::vector<BenchRow>&)>& progress) {
  return PlaceRun(std::move(place), options, budget_s, store, settings, stop, progress).run();
}

}  // namespace candela
