#include "bench/error_place.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <map>

#include "base/log.h"
#include "bench/deadline.h"
#include "bench/error_analysis.h"
#include "bench/error_judge.h"
#include "bench/error_parts.h"
#include "bench/error_screen.h"
#include "bench/error_views.h"
#include "bench/error_walk.h"
#include "bench/measured.h"
#include "metrics/compare.h"
#include "render/outputs.h"

namespace candela {
namespace {

// A row while it is measured.
struct OpenRow {
  SweepRow planned;
  std::unique_ptr<Measured> measured;
  double visit_s = 0;  // of a sample, with the frame before it
};

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
        progress_(std::move(progress)),
        first_(place_.rows.front().configuration),
        suite_(options.base) {
    settings_.timed = true;
    if (suite_.output == "png") suite_.output = "both";
  }

  Expected<BenchRun> run() {
    if (!first_.left_out.empty()) {
      for (SweepRow& row : place_.rows) add_unmeasured(row).left_out = first_.left_out;
      return finish();
    }
    announce();
    if (auto opened = open(); !opened) {
      for (SweepRow& row : place_.rows) {
        BenchRow& failed = add_unmeasured(row);
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
    sample_rounds();
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
    count = kept_views(options_.kept, first_.time_s, *session_).value_or(count);  // whatever time this run has
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
    if (int(place_.views.size()) < suite_.view_count && suite_.views.empty())
      note("{} of {} views: more do not fit the time", place_.views.size(), suite_.view_count);
    return {};
  }

  void trace() {
    TruthLimits limits = options_.truth;
    std::vector<std::string> names;
    if (time_.limited()) {
      // A fifth of the time, or until its noise is below what errors differ by.
      names = {claimed_};
      const double share = 0.2 * time_.left_s() / double(place_.views.size());
      limits.spp = std::max<uint64_t>(limits.spp, 4096), limits.noise = 1e-5;
      limits.seconds = limits.seconds > 0 ? std::min(limits.seconds, share) : share;
      limits.with_parts = false;
    } else {
      for (const std::string& name : error_reference_names())
        if (name != exact_reference) names.push_back(name);
    }
    std::vector<TruthView> views;
    for (const BenchView& view : place_.views) views.push_back({view.camera, view.time_s});
    judge_.emplace(traced_truths(job_, views, names, limits, [&] { return time_.over(); }), claimed_,
                   options_.exposures, !time_.limited());
  }

  // Without a budget: rows that sweep_places() has planned.
  void measure_all() {
    size_t done = 0;
    const double start_s = time_.elapsed_s();
    for (SweepRow& row : place_.rows) {
      if (time_.over()) {
        add_unmeasured(row).error = "the run was stopped before this was measured";
        continue;
      }
      measure(std::move(row));
      ++done;
      // Opening, and the rounds until each has its least number of samples.
      double visits_s = 0;
      for (const OpenRow& open : rows_) visits_s += open.visit_s;
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
    if (!time_.stopped() && time_.left_s() > 0) consider_walks(own);
    if (left_ > 0) note("{} settings were not measured: the time was over (--budget-s)", left_);
    if (dear_ > 0) note("{} settings were not measured: each would have taken more than the time that was left", dear_);
  }

  // Knobs a step from quality high; those that carry most error in small pictures first.
  void consider_steps() {
    if (time_.over() || rows_.empty()) return;
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
    used_ = nullptr;
    if (!screen) return;
    log::info("{}: {} knob settings were tried in pictures of {}x{}{}", first_.scene.label, screen->tried,
              small.width_px, small.height_px, screen->left > 0 ? fmt::format(", {} not", screen->left) : "");
    for (const ScreenedStep& step : screen->steps) {
      Configuration c = first_;
      c.job.quality = "high", c.job.settings = {step.setting};
      // A frame has as many more pixels; what is dear at full size waits until others have had their turn.
      const double more_s = (step.ms - screen->ms) / 1000 * divisor * divisor * visit_frames();
      const std::string name = "step " + step.setting.pass + "." + step.setting.knob;
      consider({name, std::move(c), {}, {}}, typical_s() + std::max(more_s, 0.0), 0.2);
    }
  }

  void consider_walks(const std::string& technique) {
    const auto exact = std::ranges::find_if(rows_, [&](const OpenRow& row) {
      return row.planned.suite == "whole" && row.measured->row.quality == "exact" &&
             row.measured->row.technique == technique && row.measured->can_sample();
    });
    if (exact == rows_.end()) return;
    for (const KnobRow& knob : knob_rows("exact")) {
      if (knob.kind == "look" || knob.walk.size() < 2 || !knob.beside.empty()) continue;
      for (const std::string& value : knob.walk) {
        if (value == knob.value_now) continue;
        Configuration c = exact->planned.configuration;
        c.job.settings = {{knob.pass, knob.knob, value}};
        const std::string name = knob.pass + "." + knob.knob;
        consider({"knob " + name, std::move(c), {{name, value, knob.kind, knob.passes}}, {}});
      }
    }
  }

  // Measures what is no other row's work, where its time, if it is known, fits that share of what is left.
  void consider(SweepRow row, std::optional<double> needs_s = {}, double share = 1) {
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
    used_ = nullptr;
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
      judge_->see_same(row, found->second->measured->row);
      return;
    }
    if ((needs_s ? *needs_s : estimated_s(job)) > share * time_.left_s()) {
      ++dear_;
      return;
    }
    if (OpenRow* open = measure(std::move(row))) works_.emplace(hash128(works), open);
  }

  // Of a row before it is opened. The exact end, and what is a step from it, is known by a picture of an eighth of the
  // size.
  double estimated_s(const Job& job) {
    if (job.quality != "exact") return 0.5 * typical_s();
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
  // Time of a row, the median of those before.
  double typical_s() const { return median(took_s_); }

  BenchRow& add_unmeasured(const SweepRow& row) {
    OpenRow& open = rows_.emplace_back();
    open.planned = row;
    open.measured = std::make_unique<Measured>(row.configuration, named(row.suite), settings_);
    open.measured->row.truth = claimed_;
    return open.measured->row;
  }
  const Suite& named(const std::string& name) { return suite_.name = name, suite_; }

  // Null where it failed or the time ended before its pictures were whole.
  OpenRow* measure(SweepRow planned) {
    planned.configuration.views = place_.views;
    OpenRow open{std::move(planned), nullptr, 0};
    open.measured = std::make_unique<Measured>(open.planned.configuration, named(open.planned.suite), settings_);
    if (const BenchRow* kept = kept_row(options_.kept, open.measured->row, *session_)) {
      kept_rows_.push_back(*kept);
      log::info("{}: kept from before", error_setting(*kept));
      return nullptr;
    }
    OpenRow& row = rows_.emplace_back(std::move(open));
    const double start_s = time_.elapsed_s();
    std::vector<FloatImage> images;
    const auto opened = row.measured->open_in(
        *session_, [&] { return time_.over(); },
        [&](size_t, const FrameResult& frame, const Session& session) {
          NonFinite nonfinite;
          images.push_back(
              linear_image(frame, row.planned.configuration.job, session, std::nullopt, FrameRate{}, nonfinite));
        });
    used_ = row.measured.get();
    if (!opened) {
      log::error("{}: {}", row_title(row.measured->row), opened.error().text());
      row.measured->fail_with(opened.error());
      return nullptr;
    }
    if (!*opened) {
      rows_.pop_back();
      used_ = nullptr;
      ++left_;
      return nullptr;
    }
    judge_->see(row.planned, row.measured->row, std::move(images));
    const int moment = -int(rows_.size());
    const int samples = time_.limited() ? 2 : 1;
    for (int i = 0; i < samples && (i == 0 || !time_.over()); ++i) visit(row, moment, i == 0);
    const double took_s = time_.elapsed_s() - start_s;
    took_s_.push_back(took_s);
    // The first row again, beside this one, unless that is dear.
    OpenRow& clock = rows_.front();
    if (&clock != &row && clock.measured->can_sample() && !time_.over() && clock.visit_s < 0.25 * took_s)
      visit(clock, moment, false);
    tell(row);
    save();
    return &row;
  }

  void visit(OpenRow& row, int round, bool warm) {
    const double before = time_.elapsed_s();
    const bool visited = !warm && used_ != row.measured.get();
    // A row's first sample is taken though the time is over: else its picture would have been made for nothing.
    const bool first = row.measured->row.gpu.ms.empty();
    const auto sampled = row.measured->sample_in(*session_, round, visited, [&] { return !first && time_.over(); });
    used_ = row.measured.get();
    if (!sampled) row.measured->fail_with(sampled.error());
    row.visit_s = time_.elapsed_s() - before;
  }

  void tell(const OpenRow& row) const {
    const BenchRow& r = row.measured->row;
    const auto error = error_of(r, claimed_, "relmse");
    log::info("{}: {}{}{}", error_setting(r),
              r.gpu.ms.empty() ? "no time" : fmt::format("{:.3g} ms", summary(r.gpu.ms).median),
              error ? fmt::format(", relmse {:.3g} against {}", *error, claimed_) : "",
              time_.limited() ? fmt::format(" ({:.0f} s left)", std::max(0.0, time_.left_s())) : "");
  }

  // All rows again and again, in a new order each time. Within a budget: as many rows as four rounds fit, those first
  // that no other surely beats.
  void sample_rounds() {
    for (int round = 1; !time_.over(); ++round) {
      std::vector<OpenRow*> active;
      for (OpenRow& row : rows_)
        if (row.measured->can_sample() && (time_.limited() || row.measured->wants_sample())) active.push_back(&row);
      if (active.empty()) return;
      if (time_.limited()) {
        if (round > suite_.sampling.max_runs) return;
        choose_for_rounds(active);
      }
      for (const size_t k : round_order(active.size(), suite_.sampling.order_seed, round)) {
        if (time_.over()) break;
        visit(*active[k], round, false);
      }
      save();
    }
  }

  void choose_for_rounds(std::vector<OpenRow*>& active) {
    std::vector<const BenchRow*> rows;
    for (const OpenRow* row : active) rows.push_back(&row->measured->row);
    std::map<const BenchRow*, int> rank;
    for (const ErrorPoint& point : error_points(rows, claimed_, "relmse")) rank[point.row] = int(point.standing);
    std::ranges::stable_sort(active, {}, [&](const OpenRow* row) {
      const auto found = rank.find(&row->measured->row);
      return std::pair(found == rank.end() ? 3 : found->second, row->visit_s);
    });
    constexpr double rounds = 4;
    double sum_s = 0;
    size_t count = 0;
    for (const OpenRow* row : active) {
      sum_s += row->visit_s;
      if (count >= 2 && sum_s * rounds > time_.left_s()) break;
      ++count;
    }
    active.resize(count);
  }

  // Whole techniques in the first view: what a knob does to them its study says.
  void divide() {
    if (judge_->truths().empty() || time_.stopped()) return;
    std::vector<BenchRow> rows;
    std::vector<Job> jobs;
    for (OpenRow& open : rows_) {
      rows.push_back(open.measured->row);
      Job& job = jobs.emplace_back();
      if (open.planned.suite != "whole" || rows.back().errors.empty()) continue;
      job = open.planned.configuration.job;
      job.camera = place_.views.front().camera, job.scene = job_.scene;
    }
    divide_errors(rows, jobs, place_.views.front().time_s, judge_->truths().front(), settings_,
                  [&] { return time_.stopped(); });
    size_t i = 0;
    for (OpenRow& open : rows_) open.measured->row.errors = std::move(rows[i++].errors);
  }

  std::vector<BenchRow> rows_so_far() const {
    std::vector<BenchRow> rows = kept_rows_;
    for (const OpenRow& row : rows_) rows.push_back(row.measured->row);
    return rows;
  }
  void save() const {
    if (progress_) progress_(rows_so_far());
  }

  Expected<BenchRun> finish() {
    BenchRun run;
    for (OpenRow& row : rows_) row.measured->finish();
    run.rows = rows_so_far();
    std::vector<const BenchRow*> own;
    for (const OpenRow& row : rows_) own.push_back(&row.measured->row);
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
  std::function<void(const std::vector<BenchRow>&)> progress_;
  Configuration first_;
  Suite suite_;
  Job job_;  // with the scene's file
  std::string claimed_;
  std::unique_ptr<Session> session_;
  std::optional<ErrorJudge> judge_;
  std::list<OpenRow> rows_;
  std::vector<BenchRow> kept_rows_;
  std::map<Hash128, OpenRow*> works_;
  const Measured* used_ = nullptr;  // whose settings the session has
  double opening_s_ = 0, exact_frame_s_ = 0;
  std::vector<double> took_s_;  // of each row
  int left_ = 0, dear_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace

Expected<BenchRun> run_error_place(SweepPlace place, const ErrorSweepOptions& options, double budget_s,
                                   SceneStore& store, const RunSettings& settings, const std::function<bool()>& stop,
                                   const std::function<void(const std::vector<BenchRow>&)>& progress) {
  return PlaceRun(std::move(place), options, budget_s, store, settings, stop, progress).run();
}

}  // namespace candela
