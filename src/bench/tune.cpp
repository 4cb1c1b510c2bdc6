#include "bench/tune.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "base/log.h"
#include "base/text.h"
#include "bench/deadline.h"
#include "bench/error_screen.h"
#include "bench/error_truth.h"
#include "bench/picture.h"
#include "bench/sampling.h"
#include "job/frame_choices.h"
#include "metrics/compare.h"
#include "render/outputs.h"
#include "techniques/technique.h"

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

class Tuner {
 public:
  Tuner(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop)
      : options_(options), settings_(settings), time_(options.seconds, stop) {
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
    if (const TuneTrial* quickest = try_techniques()) search(*quickest);
    refine();
    if (options_.picture) take_picture();
    if (std::string changed = settle(); !changed.empty()) report_.notes.push_back(std::move(changed));
    if (std::string quicker = quicker_reference(report_); !quicker.empty()) report_.notes.push_back(std::move(quicker));
    report_.wall_s = elapsed();
    return std::move(report_);
  }

 private:
  double elapsed() const { return time_.elapsed_s(); }
  double left_s() const { return time_.left_s(); }
  bool over() const { return time_.over(); }

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
    report_.reference_spp = truth.spp, report_.reference_ms = truth.sample_s * 1e3;
    auto small =
        traced(divided_size(base_, divisor), {.spp = 1024, .seconds = share_s / 3, .noise = 1e-5, .with_parts = false});
    small_truth_ = std::move(small.image);
    log::info("opened and traced in {:.1f} s", elapsed());
    return {};
  }

  Truth traced(const Job& job, const TruthLimits& limits) {
    return std::move(
        traced_truths(job, {{job.camera, options_.moment_s}}, {report_.reference}, limits, [&] { return over(); })
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
    clock_ = quickest->job, high_ms_ = quickest->median_ms;
    for (const char* quality : {"draft", "normal"}) {
      Job job = quickest->job;
      job.quality = quality;
      add(job);
    }
    return quickest;
  }

  // A setting as a small picture shows it.
  struct Small {
    Job job;                   // at full size
    double ms = 0, error = 0;  // ms: at full size, as the change from quality high tells
    bool expanded = false;
  };

  // A search in small pictures, then its front at full size.
  void search(const TuneTrial& high) {
    if (over() || small_truth_.width == 0) return;
    // The rest is for rounds.
    const double until_s = elapsed() + 0.8 * left_s();
    const auto ended = [&] { return over() || elapsed() > until_s; };
    for (const char* quality : {"high", "draft", "normal"}) {
      Job job = high.job;
      job.quality = quality;
      look_at(job);
    }
    if (small_.empty()) return;
    // A knob that changed neither error nor time by a fiftieth is not tried again, unless its pass has a new method.
    constexpr double least_change = 0.02;
    expand(small_.front(), {}, {}, ended);
    std::set<std::string> active;
    const Small first = small_.front();
    for (const Small& s : small_) {
      const bool one_more = s.job.settings.size() == first.job.settings.size() + 1;
      const double error = std::abs(s.error / first.error - 1), time = std::abs(s.ms / first.ms - 1);
      if (one_more && (error > least_change || time > least_change)) active.insert(name_of(s.job.settings.back()));
    }
    const std::set<std::string> of_base = active;
    for (int expansion = 1; !ended(); ++expansion) {
      if (expansion % 3 == 0) confirm(ended);
      Small* next = next_to_expand();
      if (!next) break;
      std::set<std::string> knobs = of_base, whole;
      for (const KnobRow& knob : knob_rows(next->job.quality))
        for (const KnobSetting& s : next->job.settings)
          if (knob.pass == s.pass && !is_number_text(s.value)) whole.insert(knob.pass + "." + knob.knob);
      knobs.insert(whole.begin(), whole.end());
      expand(*next, knobs, whole, ended);
    }
    confirm([&] { return over(); });
    try_times();
    log::info("{} settings were tried in small pictures", small_.size());
    if (left_ > 0)
      report_.notes.push_back(fmt::format("{} settings were not measured: the time was over (--seconds)", left_));
    if (small_left_ > 0)
      report_.notes.push_back(
          fmt::format("{} knob settings were not looked at in small pictures: the time was over", small_left_));
  }

  static std::string name_of(const KnobSetting& s) { return s.pass + "." + s.knob; }
  // A step changes what each pixel costs, and there are so many more of them.
  double full_ms(double small_ms) const {
    return std::max(0.05 * high_ms_, high_ms_ + (small_ms - small_high_ms_) * divisor * divisor);
  }

  void look_at(const Job& job) {
    const auto picture = picture_in(*session_, divided_size(job, divisor), options_.moment_s, 1);
    if (!picture) return;
    if (const auto work = session_->work(options_.moment_s)) known_.insert(work->hash);
    if (small_.empty()) small_high_ms_ = picture->ms;
    const Comparison c = compare(small_truth_, picture->image, {.encoding = Encoding::linear, .perceptual = false});
    if (const auto error = c.metrics.find("relmse"); error != c.metrics.end())
      small_.push_back({job, full_ms(picture->ms), error->second});
  }

  void expand(Small& from, const std::set<std::string>& knobs, const std::set<std::string>& whole,
              const std::function<bool()>& ended) {
    from.expanded = true;
    const Job base = from.job;
    const auto screen = screen_knobs(*session_,
                                     {.base = base,
                                      .time_s = options_.moment_s,
                                      .divisor = divisor,
                                      .truth = &small_truth_,
                                      .knobs = knobs,
                                      .whole = whole,
                                      .times = false,
                                      .known = &known_},
                                     ended);
    if (!screen) {
      report_.notes.push_back("knobs were not tried in small pictures: " + screen.error().text());
      return;
    }
    for (const ScreenedStep& step : screen->steps)
      small_.push_back({with_setting(base, step.setting), full_ms(step.ms), step.relmse});
    small_left_ += screen->left;
  }

  std::vector<Small*> small_front() {
    std::vector<Small*> order, front;
    for (Small& s : small_) order.push_back(&s);
    std::ranges::stable_sort(order, {}, [](const Small* s) { return std::pair(s->ms, s->error); });
    // A difference of a thirtieth is not worth a setting of its own.
    for (Small* s : order)
      if (front.empty() || s->error < 0.97 * front.back()->error) front.push_back(s);
    return front;
  }

  // In turn: where error times time is least, the least error, and the quickest.
  Small* next_to_expand() {
    std::vector<Small*> front = small_front();
    std::erase_if(front, [](const Small* s) { return s->expanded; });
    if (front.empty()) return nullptr;
    const int turn = turn_++ % 3;
    if (turn == 1) return front.back();
    if (turn == 2) return front.front();
    return *std::ranges::min_element(front, {}, [](const Small* s) { return s->ms * s->error; });
  }

  // The front of the small pictures at full size, from its knee outwards.
  void confirm(const std::function<bool()>& ended) {
    std::vector<Small*> front = small_front();
    std::ranges::stable_sort(front, {}, [](const Small* s) { return s->ms * s->error; });
    for (const Small* s : front)
      if (!ended()) add(s->job);
  }

  // Knobs that change nothing but time, whose gains small pictures do not show, one by one on the setting at the knee.
  void try_times() {
    const TuneTrial* knee = nullptr;
    for (const TuneTrial& t : trials_)
      if (t.usable() && (!knee || t.median_ms * t.relmse < knee->median_ms * knee->relmse)) knee = &t;
    if (!knee) return;
    const Job job = knee->job;
    const double until_s = elapsed() + 0.4 * left_s();
    for (const KnobRow& knob : knob_rows(job.quality)) {
      if (knob.kind != "time") continue;
      for (const std::string& value : knob_steps(knob)) {
        const Job changed = with_setting(job, {knob.pass, knob.knob, value});
        if (elapsed() < until_s && !over() && check_job(changed)) add(changed);
      }
    }
  }

  void take_picture() {
    constexpr int shown_px = 480;
    settle();
    const auto front = tune_front(report_);
    if (front.empty()) return;
    const auto session = Session::open(front.back()->job, {.linear = false, .display = true}, settings_);
    if (!session) return;
    if (const auto frame = (*session)->render(options_.moment_s))
      report_.picture = thumbnail_png(display_image(*frame, front.back()->job), shown_px);
  }

  void take_time(TuneTrial& trial, const FrameResult& frame) {
    trial.gpu_ms.push_back(frame.timings.frame_gpu_ms);
    trial.moments.push_back(clock_ms_.size());
    trial.ms = time_interval(trial.gpu_ms, {});
    trial.median_ms = median(trial.gpu_ms);
  }

  // One setting again, beside each that is measured, unless that is dear: what it takes says how the clocks are.
  void look_at_clock(const TuneTrial& beside) {
    if (clock_.scene.empty() || over() || high_ms_ > 2 * beside.median_ms + 10) return;
    const auto picture = picture_in(*session_, clock_, options_.moment_s, 1);
    if (picture) clock_ms_.push_back(picture->ms);
  }

  std::string settle() {
    report_.trials.assign(trials_.begin(), trials_.end());
    return settle_times(report_.trials, clock_ms_);
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
    const auto first = session_->render(options_.moment_s);
    if (!first) return failed(first.error());
    for (int i = 0; i < first_frames && (i == 0 || !over()); ++i) {
      const auto frame = session_->render(options_.moment_s);
      if (!frame) return failed(frame.error());
      take_time(trial, *frame);
    }
    // After the times: a device that waits for a comparison lowers its clocks.
    NonFinite nonfinite;
    const FloatImage image = linear_image(*first, trial.job, *session_, std::nullopt, FrameRate{}, nonfinite);
    look_at_clock(trial);
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
      settle();
      for (const TuneTrial* on_front : tune_front(report_)) {
        if (over()) break;
        TuneTrial& trial = trials_[size_t(on_front - report_.trials.data())];
        if (!session_->set_settings(trial.job)) continue;
        for (int i = 0; i < 2; ++i) {  // the first untimed: images are made anew
          const auto frame = session_->render(options_.moment_s);
          if (frame && i > 0) take_time(trial, *frame);
          if (over()) break;
        }
        look_at_clock(trial);
      }
    }
  }

  const TuneOptions& options_;
  RunSettings settings_;
  Deadline time_;
  Job base_;
  std::unique_ptr<Session> session_;
  FloatImage truth_, small_truth_;
  std::deque<Small> small_;                 // all that was tried in small pictures; quality high first
  std::set<Hash128> known_;                 // works that were
  Job clock_;                               // the quickest technique at quality high; no scene: not known yet
  std::vector<double> clock_ms_;            // it, again and again
  double high_ms_ = 0, small_high_ms_ = 0;  // its time, and that of its small picture
  int turn_ = 0, small_left_ = 0;
  TuneReport report_;
  std::deque<TuneTrial> trials_;  // pointers to them last
  std::vector<Hash128> works_;    // of each
  int left_ = 0;
};

}  // namespace

Expected<TuneReport> tune(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop) {
  return Tuner(options, settings, stop).run();
}

}  // namespace candela
