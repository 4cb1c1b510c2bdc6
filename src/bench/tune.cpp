#include "bench/tune.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>

#include "base/log.h"
#include "base/text.h"
#include "bench/error_screen.h"
#include "bench/error_truth.h"
#include "bench/picture.h"
#include "frame/plan_frame.h"
#include "metrics/compare.h"
#include "render/outputs.h"

namespace candela {
namespace {

constexpr int first_frames = 2;  // timed, of a trial when it is tried
constexpr int divisor = 4;       // of width and height of the small pictures

std::string options_text(const Job& job) {
  std::string text = fmt::format("--technique {} --quality {}", job.technique, job.quality);
  if (job.samples > 0) text += fmt::format(" --samples {}", job.samples);
  for (const KnobSetting& s : job.settings) text += fmt::format(" --set {}.{}={}", s.pass, s.knob, s.value);
  return text;
}

Job with_setting(Job job, const KnobSetting& setting) {
  std::erase_if(job.settings,
                [&](const KnobSetting& s) { return s.pass == setting.pass && s.knob == setting.knob; });
  job.settings.push_back(setting);
  return job;
}

class Tuner {
 public:
  Tuner(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), stop_(stop), start_(Clock::now()) {
    settings_.timed = true;
    base_ = options.job;
    base_.settings.clear(), base_.samples = 0;
    base_.quality = "high";
  }

  Expected<TuneReport> run() {
    log::info(
        "tune, {}x{}: at most {:.0f} s, the traced reference included; techniques and qualities first, then knobs one "
        "by one in pictures of {}x{}, then their sums at full size",
        base_.width_px, base_.height_px, options_.seconds, divided_size(base_, divisor).width_px,
        divided_size(base_, divisor).height_px);
    if (auto opened = open(); !opened) return std::unexpected(opened.error());
    if (const TuneTrial* best = try_techniques()) {
      const Job from = best->job;
      walk_knobs(from);
    }
    refine();
    if (options_.picture) take_picture();
    report_.trials.assign(trials_.begin(), trials_.end());
    report_.wall_s = elapsed();
    return std::move(report_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double left_s() const { return options_.seconds - elapsed(); }
  bool over() const { return stop_() || left_s() <= 0; }

  Expected<void> open() {
    auto session = Session::open(base_, {.linear = true, .display = false}, settings_);
    if (!session) return std::unexpected(session.error());
    session_ = std::move(*session);
    report_.device = session_->device().info().name;
    report_.reference = claimed_reference(base_, session_->scene());
    // Small pictures need few samples more than large ones, and are a sixteenth of them.
    const double share_s = 0.15 * left_s();
    auto truth = traced(base_, {.spp = 1024, .seconds = share_s, .noise = 1e-5, .with_parts = false});
    if (!truth.failed.empty())
      return fail(ErrorKind::input, options_.job.scene, "there is no reference to judge settings by: {}", truth.failed);
    truth_ = std::move(truth.image);
    report_.reference_spp = truth.spp;
    auto small = traced(divided_size(base_, divisor),
                        {.spp = 1024, .seconds = share_s / 3, .noise = 1e-5, .with_parts = false});
    small_truth_ = std::move(small.image);
    log::info("opened and traced in {:.1f} s", elapsed());
    return {};
  }

  Truth traced(const Job& job, const TruthLimits& limits) {
    return std::move(traced_truths(job, {{job.camera, options_.moment_s}}, {report_.reference}, limits, stop_)
                         .front()
                         .front());
  }

  // The quickest of the techniques at quality high.
  const TuneTrial* try_techniques() {
    std::vector<std::string> techniques = technique_names();
    std::erase(techniques, base_.technique);
    if (base_.technique != auto_technique) techniques.insert(techniques.begin(), base_.technique);
    const TuneTrial* quickest = nullptr;
    for (const std::string& technique : techniques) {
      Job job = base_;
      job.technique = technique;
      const TuneTrial* trial = add(job);
      if (trial && trial->usable() && (!quickest || trial->median_ms < quickest->median_ms)) quickest = trial;
    }
    if (!quickest) return nullptr;
    for (const char* quality : {"draft", "normal"}) {
      Job job = quickest->job;
      job.quality = quality;
      add(job);
    }
    return quickest;
  }

  // In small pictures each knob one by one; at full size their sums, from both ends.
  void walk_knobs(const Job& from) {
    const std::vector<ScreenedStep> steps = screened(from, {}, 0.35);
    std::vector<ScreenedStep> better, cheaper;
    for (const ScreenedStep& s : steps) {
      if (s.relmse < screen_.relmse) better.push_back(s);
      if (s.ms < screen_.ms) cheaper.push_back(s);
    }
    const double ms = screen_.ms, error = screen_.relmse;
    // Error taken away for each millisecond; a step that is quicker, too, comes first.
    std::ranges::stable_sort(better, {}, [&](const ScreenedStep& s) {
      return -(error - s.relmse) / std::max(s.ms - ms, 0.01 * ms);
    });
    std::ranges::stable_sort(cheaper, {}, [&](const ScreenedStep& s) {
      return std::max(s.relmse - error, 0.0) / (ms - s.ms);
    });
    Job exact = from;
    const TuneTrial* before = find(from);
    int taken = 0;
    for (const ScreenedStep& step : better) {
      if (over()) break;
      const TuneTrial* trial = add(with_setting(exact, step.setting));
      if (!trial || !trial->usable()) continue;
      // Each method that is left for another has knobs of its own, which nothing has walked yet.
      const TuneTrial* best = trial;
      if (taken < 3 && !is_number(step.setting.value)) best = walk_passes(*trial, step.setting.pass);
      if (!before || best->relmse >= before->relmse) continue;
      exact = best->job, before = best, ++taken;
    }
    for (const Job& start : {from, exact}) {
      Job job = start;
      for (const ScreenedStep& step : cheaper) {
        if (over()) break;
        const auto same = [&](const KnobSetting& s) { return s.pass == step.setting.pass && s.knob == step.setting.knob; };
        if (std::ranges::any_of(job.settings, same)) continue;
        const Job next = with_setting(job, step.setting);
        const TuneTrial* trial = add(next);
        const TuneTrial* own = find(job);
        // Where it brings no time at full size it is left out of the sum.
        if (trial && trial->usable() && own && trial->median_ms < own->median_ms) job = next;
      }
      if (options_text(exact) == options_text(from)) break;
    }
    if (left_ > 0) report_.notes.push_back(fmt::format("{} settings were not tried: the time was over (--seconds)", left_));
  }

  static bool is_number(const std::string& text) {
    return text.find_first_not_of("0123456789.eE+-") == std::string::npos;
  }

  std::vector<ScreenedStep> screened(const Job& base, const std::set<std::string>& passes, double share) {
    if (over() || small_truth_.width == 0) return {};
    const double until = elapsed() + share * left_s();
    auto screen = screen_knobs(*session_, {.base = base, .time_s = options_.moment_s, .divisor = divisor,
                                           .truth = &small_truth_, .passes = passes, .frames = first_frames},
                               [&] { return over() || elapsed() > until; });
    if (!screen) {
      report_.notes.push_back("knobs were not tried in small pictures: " + screen.error().text());
      return {};
    }
    if (passes.empty())
      log::info("{} knob settings tried in small pictures{}", screen->tried,
                screen->left > 0 ? fmt::format(", {} not, for want of time", screen->left) : "");
    screen_ = *screen;
    return std::move(screen->steps);
  }

  // Error knobs of a pass, one after the other down to what saves time, from a setting that has chosen its method.
  const TuneTrial* walk_passes(const TuneTrial& from, const std::string& pass) {
    const TuneTrial* best = &from;
    for (const KnobRow& knob : knob_rows(from.job.quality)) {
      if (knob.pass != pass || knob.kind != "error" || !is_number(knob.value_now)) continue;
      std::vector<std::string> values;
      for (const std::string& value : knob.walk)
        if (std::strtod(value.c_str(), nullptr) < std::strtod(knob.value_now.c_str(), nullptr) &&
            std::ranges::find(values, value) == values.end())
          values.push_back(value);
      // From the value at hand towards the cheapest, as long as it saves time.
      std::ranges::sort(values, [](const std::string& a, const std::string& b) {
        return std::strtod(a.c_str(), nullptr) > std::strtod(b.c_str(), nullptr);
      });
      const TuneTrial* last = best;
      for (const std::string& value : values) {
        const TuneTrial* trial = add(with_setting(best->job, {knob.pass, knob.knob, value}));
        if (!trial || !trial->usable() || trial->median_ms >= last->median_ms) break;
        last = trial;
        // Error for time: on a log scale it must bring more than it takes.
        if (trial->median_ms * trial->relmse < best->median_ms * best->relmse) best = trial;
      }
    }
    return best;
  }

  void take_picture() {
    constexpr int shown_px = 480;
    report_.trials.assign(trials_.begin(), trials_.end());
    const auto front = tune_front(report_);
    if (front.empty()) return;
    const auto session = Session::open(front.back()->job, {.linear = false, .display = true}, settings_);
    if (!session) return;
    if (const auto frame = (*session)->render(options_.moment_s))
      report_.picture = thumbnail_png(display_image(*frame, front.back()->job), shown_px);
  }

  void take_time(TuneTrial& trial, const FrameResult& frame) {
    trial.gpu_ms.push_back(frame.timings.frame_gpu_ms);
    trial.ms = median_interval(trial.gpu_ms);
    trial.median_ms = median(trial.gpu_ms);
  }

  // Renders and measures; null when the time is over, or where the setting is no other than one that was tried.
  const TuneTrial* add(const Job& job) {
    if (over() && !trials_.empty()) {  // one is measured whatever it takes
      ++left_;
      return nullptr;
    }
    if (const TuneTrial* tried = find(job)) return tried;
    TuneTrial trial{.job = job, .options = options_text(job)};
    Hash128 work;
    measure(trial, work);
    log::info("{}: {} ({:.0f} s left)", trial.options,
              !trial.failed.empty()    ? trial.failed
              : !trial.same_as.empty() ? "the same as " + trial.same_as
                                       : fmt::format("{:.3g} ms, relmse {:.3g}", trial.median_ms, trial.relmse),
              std::max(0.0, left_s()));
    trials_.push_back(std::move(trial));
    works_.push_back(work);
    const TuneTrial& added = trials_.back();
    return added.same_as.empty() ? &added : find_options(added.same_as);
  }

  void measure(TuneTrial& trial, Hash128& own_work) {
    const auto failed = [&](const Error& error) { trial.failed = error.text(); };
    if (auto set = session_->set_settings(trial.job); !set) return failed(set.error());
    const auto work = session_->work(options_.moment_s);
    if (!work) return failed(work.error());
    own_work = work->hash;
    for (size_t i = 0; i < trials_.size(); ++i)
      if (works_[i] == own_work && trials_[i].usable()) {
        trial.same_as = trials_[i].options;
        return;
      }
    for (int i = 0; i <= first_frames; ++i) {
      if (i > 1 && over()) return;
      const auto frame = session_->render(options_.moment_s);
      if (!frame) return failed(frame.error());
      if (i > 0) {
        take_time(trial, *frame);
        continue;
      }
      NonFinite nonfinite;
      const FloatImage image = linear_image(*frame, trial.job, *session_, std::nullopt, FrameRate{}, nonfinite);
      const Comparison c = compare(truth_, image, {.encoding = Encoding::linear});
      if (!c.refusal.empty()) {
        trial.failed = c.refusal;
        return;
      }
      const auto metric = [&](const char* name) {
        const auto found = c.metrics.find(name);
        return found == c.metrics.end() ? INFINITY : found->second;
      };
      trial.relmse = metric("relmse"), trial.flip = metric("flip");
      if (c.noise) report_.noise = c.noise->relmse;
    }
  }

  const TuneTrial* find(const Job& job) const { return find_options(options_text(job)); }
  const TuneTrial* find_options(const std::string& options) const {
    const auto found = std::ranges::find(trials_, options, &TuneTrial::options);
    if (found == trials_.end()) return nullptr;
    return found->same_as.empty() ? &*found : find_options(found->same_as);
  }

  // A machine that others use is not the same later: what is on the front is measured again, one after the other, and
  // what is no longer on it is left out.
  void refine() {
    constexpr int rounds = 16;
    for (int round = 0; round < rounds && !over(); ++round) {
      report_.trials.assign(trials_.begin(), trials_.end());
      for (const TuneTrial* on_front : tune_front(report_)) {
        if (over()) break;
        TuneTrial& trial = trials_[size_t(on_front - report_.trials.data())];
        if (!session_->set_settings(trial.job)) continue;
        for (int i = 0; i < 2; ++i) {  // the first untimed: images are made anew
          const auto frame = session_->render(options_.moment_s);
          if (frame && i > 0) take_time(trial, *frame);
          if (over()) break;
        }
      }
    }
  }

  const TuneOptions& options_;
  RunSettings settings_;
  const std::function<bool()>& stop_;
  Clock::time_point start_;
  Job base_;
  std::unique_ptr<Session> session_;
  FloatImage truth_, small_truth_;
  Screen screen_;  // of the base that was screened last
  TuneReport report_;
  std::deque<TuneTrial> trials_;  // pointers to them last
  std::vector<Hash128> works_;    // of each
  int left_ = 0;
};

// What errors may differ by and still cannot be told apart.
double indistinct(const TuneReport& report, double error) { return std::max(3 * report.noise, 0.01 * error); }

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

const TuneTrial* least_error(const TuneReport& report) {
  const auto front = tune_front(report);
  return front.empty() ? nullptr : front.back();
}

std::vector<TuneChoice> most_exact_within(const TuneReport& report, std::span<const double> ms) {
  std::vector<TuneChoice> choices;
  for (const double most : ms) {
    TuneChoice choice{most};
    for (const TuneTrial* t : tune_front(report))
      if (t->ms.high <= most) choice.trial = t;
    if (choice.trial) {
      const double bound = choice.trial->relmse + indistinct(report, choice.trial->relmse);
      for (const TuneTrial* t : tune_front(report))
        if (t->relmse <= bound && t->median_ms < choice.trial->median_ms) choice.trial = t;
    }
    choices.push_back(choice);
  }
  return choices;
}

}  // namespace candela
