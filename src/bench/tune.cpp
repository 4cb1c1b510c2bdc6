#include "bench/tune.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/log.h"
#include "base/text.h"
#include "bench/picture.h"
#include "frame/plan_frame.h"
#include "metrics/compare.h"
#include "render/outputs.h"

namespace candela {
namespace {

constexpr size_t first_frames = 6;  // of a trial: the fewest that an interval of 95 % can be said of

std::string options_text(const Job& job) {
  std::string text = fmt::format("--technique {} --quality {}", job.technique, job.quality);
  if (job.samples > 0) text += fmt::format(" --samples {}", job.samples);
  for (const KnobSetting& s : job.settings) text += fmt::format(" --set {}.{}={}", s.pass, s.knob, s.value);
  return text;
}

class Tuner {
 public:
  Tuner(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), stop_(stop), start_(Clock::now()) {
    settings_.timed = true;
    base_ = options.job;
    base_.settings.clear(), base_.samples = 0;
  }

  Expected<TuneReport> run() {
    if (auto traced = find_exact(); !traced) return std::unexpected(traced.error());
    for (const std::string& technique : technique_names())
      for (const char* quality : {"draft", "normal", "high"}) {
        Job job = base_;
        job.technique = technique, job.quality = quality;
        add(job);
      }
    if (const TuneTrial* high = best_of("high")) {
      const Job best = high->job;
      try_more_exact(best);
      try_knobs(best);
    }
    refine();
    if (options_.picture) take_picture();
    report_.wall_s = elapsed();
    return std::move(report_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool over() const { return stop_() || elapsed() > options_.seconds; }

  // A picture of the job at a size; its colour, linear.
  // frame_s: wall time of a second frame, with all that the first had to make.
  Expected<FloatImage> picture(Job job, int width, int height, double* frame_s = nullptr) {
    job.width_px = width, job.height_px = height;
    auto session = Session::open(job, {.linear = true, .display = false}, settings_);
    if (!session) return std::unexpected(session.error());
    auto frame = (*session)->render(options_.moment_s);
    if (!frame) return std::unexpected(frame.error());
    report_.device = (*session)->device().info().name;
    if (frame_s) {
      const double before = elapsed();
      frame = (*session)->render(options_.moment_s);
      if (!frame) return std::unexpected(frame.error());
      *frame_s = elapsed() - before;
    }
    NonFinite nonfinite;
    return linear_image(*frame, job, **session, std::nullopt, FrameRate{}, nonfinite);
  }

  // At the full size where that takes no more than a third of the time, else at the largest half, quarter, ... that
  // does.
  Expected<void> find_exact() {
    Job job = base_;
    job.quality = "exact";
    constexpr int probe = 8;
    double pixels = 0, seconds = 0;
    for (int divisor = probe;; divisor /= 2) {
      const int width = std::max(1, job.width_px / divisor), height = std::max(1, job.height_px / divisor);
      const double next = double(width) * height;
      if (pixels > 0 && elapsed() + 2 * seconds * next / pixels > options_.seconds / 3) {
        report_.notes.push_back(
            fmt::format("errors are of pictures of {}x{}: the exact one of {}x{} would take about {:.0f} s",
                        report_.error_width_px, report_.error_height_px, job.width_px, job.height_px,
                        seconds * double(job.width_px) * job.height_px / pixels));
        return {};
      }
      auto image = picture(job, width, height, &seconds);
      if (!image) return std::unexpected(image.error());
      exact_ = std::move(*image);
      report_.error_width_px = width, report_.error_height_px = height;
      pixels = next;
      report_.exact_ms = seconds * 1e3;
      if (divisor == 1) return {};
      if (over()) {
        report_.notes.push_back("the time was over before an exact picture of the size asked for");
        return {};
      }
    }
  }

  void take_picture() {
    constexpr int shown_px = 480;
    const auto front = tune_front(report_);
    if (front.empty()) return;
    const auto session = Session::open(front.back()->job, {.linear = false, .display = true}, settings_);
    if (!session) return;
    if (const auto frame = (*session)->render(options_.moment_s))
      report_.picture = thumbnail_png(display_image(*frame, front.back()->job), shown_px);
  }

  bool measures_at_full_size() const {
    return report_.error_width_px == base_.width_px && report_.error_height_px == base_.height_px;
  }

  void take_frames(TuneTrial& trial, Session& session, size_t count) {
    for (size_t i = 0; i < count && !stop_(); ++i) {
      const auto frame = session.render(options_.moment_s);
      if (!frame) {
        trial.failed = frame.error().text();
        return;
      }
      double ms = 0;
      for (const gpu::PassTime& pass : frame->timings.gpu_ms) ms += pass.gpu_ms;
      trial.gpu_ms.push_back(ms);
    }
    trial.ms = median_interval(trial.gpu_ms);
    trial.median_ms = median(trial.gpu_ms);
  }

  void compare_with_exact(TuneTrial& trial, const FloatImage& image) {
    const Comparison c = compare(exact_, image, {.encoding = Encoding::linear});
    trial.relmse = c.metrics.contains("relmse") ? c.metrics.at("relmse") : INFINITY;
    trial.flip = c.metrics.contains("flip") ? c.metrics.at("flip") : INFINITY;
    if (!c.refusal.empty()) trial.failed = c.refusal;
  }

  // Renders and measures; null when the time is over.
  TuneTrial* add(const Job& job) {
    if (over() && !report_.trials.empty()) {  // one is measured whatever it takes
      ++left_;
      return nullptr;
    }
    TuneTrial trial{.job = job, .options = options_text(job)};
    plans_.emplace_back();
    measure(trial);
    log::info("{}: {}", trial.options,
              !trial.failed.empty()    ? trial.failed
              : !trial.same_as.empty() ? "the same as " + trial.same_as
                                       : fmt::format("{:.3g} ms, relmse {:.3g}", trial.median_ms, trial.relmse));
    report_.trials.push_back(std::move(trial));
    return &report_.trials.back();
  }

  void measure(TuneTrial& trial) {
    auto session = Session::open(trial.job, {.linear = true, .display = false}, settings_);
    if (!session) {
      trial.failed = session.error().text();
      return;
    }
    const auto first = (*session)->render(options_.moment_s);
    if (!first) {
      trial.failed = first.error().text();
      return;
    }
    const std::string plan = first->plan_hash.hex();
    if (measures_at_full_size()) {
      NonFinite nonfinite;
      compare_with_exact(trial, linear_image(*first, trial.job, **session, std::nullopt, FrameRate{}, nonfinite));
    } else if (auto image = picture(trial.job, report_.error_width_px, report_.error_height_px)) {
      compare_with_exact(trial, *image);
    } else {
      trial.failed = image.error().text();
    }
    if (!trial.failed.empty()) return;
    for (size_t i = 0; i < report_.trials.size(); ++i)
      if (plans_[i] == plan && report_.trials[i].relmse == trial.relmse && report_.trials[i].usable())
        trial.same_as = report_.trials[i].options;
    plans_.back() = plan;
    if (trial.same_as.empty()) take_frames(trial, **session, first_frames);
  }

  const TuneTrial* best_of(const std::string& quality) const {
    const TuneTrial* best = nullptr;
    for (const TuneTrial& t : report_.trials)
      if (t.usable() && t.job.quality == quality && (!best || t.median_ms < best->median_ms)) best = &t;
    return best;
  }

  // More samples a pixel, and the exact end itself where its frames are few seconds.
  void try_more_exact(const Job& best) {
    for (const char* n : {"2", "4"}) {
      Job job = best;
      job.settings.push_back({"supersample", "n", n});
      if (check_job(job)) add(job);
    }
    if (!measures_at_full_size() || report_.exact_ms * 1e-3 * (first_frames + 2) > options_.seconds / 4) return;
    Job job = best;
    job.quality = "exact";
    add(job);
  }

  struct Step {
    KnobSetting setting;
    double saved_ms = 0, added = 0;  // per step: time and error against the base's
  };

  // The values of each knob beside its own, alone; then those that were surely faster, one after the other.
  void try_knobs(Job base) {
    const TuneTrial from = *find(base);
    std::vector<Step> cheaper;
    for (const KnobRow& knob : knob_rows(base.quality)) {
      if (knob.kind == "look") continue;
      const auto now = std::find(knob.walk.begin(), knob.walk.end(), knob.value_now);
      std::vector<std::string> values;
      if (now != knob.walk.end() && now != knob.walk.begin()) values.push_back(*(now - 1));
      if (now != knob.walk.end() && now + 1 != knob.walk.end()) values.push_back(*(now + 1));
      for (const std::string& value : values) {
        Job job = base;
        job.settings.push_back({knob.pass, knob.knob, value});
        if (!check_job(job)) continue;
        const TuneTrial* trial = add(job);
        if (trial && trial->usable() && trial->ms.high < from.ms.low)
          cheaper.push_back({job.settings.back(), from.median_ms - trial->median_ms, trial->relmse - from.relmse});
      }
    }
    // What is cheaper and no worse first, then by error added for each millisecond saved.
    std::sort(cheaper.begin(), cheaper.end(), [](const Step& a, const Step& b) {
      return std::max(a.added, 0.0) / a.saved_ms < std::max(b.added, 0.0) / b.saved_ms;
    });
    Job job = base;
    for (const Step& step : cheaper) {
      if (std::any_of(job.settings.begin(), job.settings.end(),
                      [&](const KnobSetting& s) { return s.pass == step.setting.pass && s.knob == step.setting.knob; }))
        continue;
      job.settings.push_back(step.setting);
      if (job.settings.size() > 1 && check_job(job)) add(job);
    }
  }

  const TuneTrial* find(const Job& job) const {
    const std::string options = options_text(job);
    for (const TuneTrial& t : report_.trials)
      if (t.options == options) return &t;
    return nullptr;
  }

  // A machine that others use is not the same later: the front is measured again, up to four times.
  void refine() {
    for (int round = 0; round < 3; ++round)
      for (const TuneTrial* on_front : tune_front(report_)) {
        if (over()) break;
        TuneTrial& trial = report_.trials[size_t(on_front - report_.trials.data())];
        auto session = Session::open(trial.job, {.linear = true, .display = false}, settings_);
        if (!session || !(*session)->render(options_.moment_s)) continue;
        take_frames(trial, **session, first_frames);
      }
    if (left_ > 0)
      report_.notes.push_back(fmt::format("{} settings were not tried: the time was over (--seconds)", left_));
  }

  const TuneOptions& options_;
  RunSettings settings_;
  const std::function<bool()>& stop_;
  Clock::time_point start_;
  Job base_;
  FloatImage exact_;
  TuneReport report_;
  std::vector<std::string> plans_;  // of each trial, that at hand the last; empty where it failed
  int left_ = 0;
};

}  // namespace

Expected<TuneReport> tune(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop) {
  return Tuner(options, settings, stop).run();
}

std::vector<const TuneTrial*> tune_front(const TuneReport& report) {
  std::vector<const TuneTrial*> order, front;
  for (const TuneTrial& t : report.trials)
    if (t.usable()) order.push_back(&t);
  std::stable_sort(order.begin(), order.end(), [](const TuneTrial* a, const TuneTrial* b) {
    return std::pair(a->median_ms, a->relmse) < std::pair(b->median_ms, b->relmse);
  });
  for (const TuneTrial* t : order)
    if (front.empty() || t->relmse < front.back()->relmse) front.push_back(t);
  return front;
}

std::vector<TuneChoice> cheapest_within(const TuneReport& report, std::span<const double> errors) {
  std::vector<TuneChoice> choices;
  for (const double error : errors) {
    TuneChoice choice{error};
    for (const TuneTrial* t : tune_front(report))
      if (t->relmse <= error && !choice.trial) choice.trial = t;
    choices.push_back(choice);
  }
  return choices;
}

std::vector<TuneChoice> most_exact_within(const TuneReport& report, std::span<const double> ms) {
  std::vector<TuneChoice> choices;
  for (const double most : ms) {
    TuneChoice choice{most};
    for (const TuneTrial* t : tune_front(report))
      if (t->ms.high <= most) choice.trial = t;
    choices.push_back(choice);
  }
  return choices;
}

}  // namespace candela
