#include "bench/run_suite.h"

#include <chrono>

#include "base/clock.h"
#include "base/log.h"
#include "bench/measured.h"
#include "bench/picture.h"
#include "bench/scene_store.h"
#include "session/timings.h"

namespace candela {
namespace {

constexpr const char* stopped_before = "the run was stopped before this was measured";

struct Item {
  const Suite* suite;
  Configuration configuration;
  std::string group;
};

class SuiteRun {
 public:
  SuiteRun(const std::vector<Suite>& suites, std::vector<Item> items, const RunSettings& settings,
           const std::function<bool()>& stop)
      : settings_(settings), stop_(stop), items_(std::move(items)) {
    // The run's budget is the sum of the suites'; one suite without a budget makes it endless.
    bool endless = false;
    for (const Suite& suite : suites) {
      endless = endless || suite.budget_s <= 0;
      budget_s_ += suite.budget_s;
    }
    if (endless) budget_s_ = 0;
  }

  SuiteRun(const std::vector<RunItem>& items, double budget_s, const RunSettings& settings,
           const std::function<bool()>& stop, const SeeFirstFrame& seen)
      : settings_(settings), stop_(stop), budget_s_(budget_s), seen_(seen) {
    for (const RunItem& item : items) items_.push_back({item.suite, item.configuration, {}});
  }

  Expected<BenchRun> run();

 private:
  void open_all();
  void open_one(size_t i);
  void keep_or_close(size_t i);
  void check_picture(const Item& item, Measured& measured);
  void make_reference(const Item& item);
  void sample_rounds();
  std::vector<size_t> wanting();  // rows that take part in the next round
  bool stopped();
  bool out_of_time();
  void finish();

  RunSettings settings_;
  const std::function<bool()>& stop_;
  double budget_s_ = 0;  // 0: none
  SeeFirstFrame seen_;   // of chosen items
  Clock::time_point start_ = Clock::now(), sampling_ = start_;
  bool budget_hit_ = false;
  int open_ = 0, reopened_ = 0;
  uint64_t device_bytes_ = 0;  // of the sessions that stay open
  SceneStore store_;
  std::vector<Item> items_;
  std::vector<std::unique_ptr<Measured>> measured_;  // one an item, in the same order
  BenchRun result_;
  // The reference picture of the group at hand.
  std::string group_, reference_technique_, reference_note_;
  std::optional<Beauty> reference_;
};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Up to how many lights the reference technique is rendered.
int reference_limit(const Suite& suite) {
  if (suite.reference_max_lights > 0) return suite.reference_max_lights;
  const auto limit = suite.max_lights.find(suite.reference);
  return limit == suite.max_lights.end() ? std::numeric_limits<int>::max() : limit->second;
}

bool SuiteRun::stopped() {
  if (stop_ && stop_()) result_.stopped = true;
  return result_.stopped;
}

bool SuiteRun::out_of_time() {
  if (budget_s_ > 0 && seconds_since(sampling_) > budget_s_) budget_hit_ = true;
  return budget_hit_;
}

// The suite's reference technique where its number of lights is not limited, else the first technique of the group.
// When the reference is itself measured, it is opened first and its picture is taken; otherwise it is rendered once.
void SuiteRun::make_reference(const Item& item) {
  group_ = item.group;
  reference_.reset();
  reference_note_.clear();
  reference_technique_ = item.suite->reference;
  const int most = reference_limit(*item.suite);
  if (item.configuration.lights.value_or(0) > most) {
    for (const Item& other : items_)
      if (other.group == group_ && other.configuration.left_out.empty()) {
        reference_technique_ = other.configuration.job.technique;
        break;
      }
    reference_note_ = fmt::format("{} is limited to {} lights", item.suite->reference, most);
  }
  const Configuration wanted = reference_of(item.configuration, reference_technique_);
  reference_technique_ = wanted.job.technique;
  for (size_t i = 0; i < items_.size(); ++i)
    if (items_[i].group == group_ && items_[i].configuration.left_out.empty() &&
        job_json(items_[i].configuration.job) == job_json(wanted.job)) {
      open_one(i);
      reference_ = measured_[i]->beauty();
      if (reference_) return;
    }
  auto frame = render_once(wanted, store_, settings_, {.linear = true, .display = false}, 0);
  if (frame) {
    reference_ = std::move(frame->beauty);
  } else {
    reference_technique_.clear();
    reference_note_ = "the reference failed: " + frame.error().text();
    log::warning("{}", reference_note_);
  }
}

void SuiteRun::check_picture(const Item& item, Measured& measured) {
  BenchRow& row = measured.row;
  // What is slow is not rendered once more for its lists and its thumbnail.
  constexpr double slow_ms = 20'000;
  std::optional<Beauty> beauty = measured.beauty();
  const std::vector<std::string> layers = light_list_layers();
  if (layers.empty()) row.lists_note = "this build has no layers of light lists";
  // The heat maps test every light at every pixel.
  constexpr double most_tests = 5e9;
  const double tests = double(std::max<int64_t>(row.lights, 0)) * row.width_px * row.height_px;
  if (measured.first_frame_ms() < slow_ms) {
    Configuration seen = item.configuration;
    if (tests <= most_tests)
      seen.job.layers = layers;
    else
      row.lists_note = fmt::format("counting would test {} lights at every pixel", row.lights);
    auto frame = render_once(seen, store_, settings_, {.linear = true, .display = true}, thumbnail_px);
    if (frame) {
      row.lists = frame->lists;
      row.thumbnail = std::move(frame->thumbnail);
      row.heatmap = std::move(frame->heatmap);
      if (!beauty) beauty = std::move(frame->beauty);
      if (!seen.job.layers.empty() && !row.lists) row.lists_note = "the technique has no light lists";
    } else {
      row.lists_note = frame.error().text();
    }
  } else {
    row.lists_note = fmt::format("a frame takes {:.0f} s", measured.first_frame_ms() / 1000);
  }
  row.picture.note = reference_note_;
  if (!reference_ || !beauty) {
    if (row.picture.note.empty()) row.picture.note = "there is no linear picture";
    return;
  }
  const PictureDifference d = difference(*reference_, *beauty);
  row.picture.reference = reference_technique_;
  row.picture.differing = d.differing;
  row.picture.max_difference = d.max_difference;
  if (d.differing > 0)
    log::warning("{}: {} pixels differ from {}, the first at {}, {}", row_title(row), d.differing, reference_technique_,
                 d.first_x, d.first_y);
}

void SuiteRun::open_one(size_t i) {
  if (measured_[i]) return;
  const Item& item = items_[i];
  measured_[i] = std::make_unique<Measured>(item.configuration, *item.suite, settings_);
  Measured& measured = *measured_[i];
  if (!item.configuration.left_out.empty()) {
    measured.row.left_out = item.configuration.left_out;
    return;
  }
  if (stopped()) {
    measured.row.error = stopped_before;
    return;
  }
  log::info("{}", row_title(measured.row));
  const auto file = store_.file_of(item.configuration);
  const auto opened = file ? measured.open(*file,
                                           [&](const FrameResult& frame, const Session& session) {
                                             if (seen_) seen_(i, measured.row, frame, session);
                                           })
                           : std::unexpected(file.error());
  if (!opened) {
    log::error("{}: {}", row_title(measured.row), opened.error().text());
    measured.fail_with(opened.error());
  }
}

// Configurations whose sessions do not fit are closed again.
void SuiteRun::keep_or_close(size_t i) {
  const int most = items_[i].suite->sampling.max_sessions;
  Measured& measured = *measured_[i];
  if (most > 0 ? open_ < most : measured.fits_beside(open_, device_bytes_)) {
    ++open_;
    device_bytes_ += measured.device_bytes();
  } else {
    measured.close();
    ++reopened_;
  }
}

void SuiteRun::open_all() {
  measured_.resize(items_.size());
  for (size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    if (!seen_ && item.configuration.left_out.empty() && item.group != group_ && !stopped()) make_reference(item);
    open_one(i);
    if (!measured_[i]->can_sample()) continue;
    if (!seen_) check_picture(item, *measured_[i]);
    measured_[i]->forget_beauty();
    keep_or_close(i);
  }
  if (reopened_ > 0)
    result_.notes.push_back(fmt::format(
        "{} of {} configurations were reopened for every sample: {}", reopened_, open_ + reopened_,
        items_.front().suite->sampling.max_sessions > 0 ? "of max_sessions" : "the device does not hold all at once"));
}

// All that want more runs; beyond the budget only those that lack their least number.
std::vector<size_t> SuiteRun::wanting() {
  std::vector<size_t> rows;
  for (size_t i = 0; i < items_.size(); ++i) {
    Measured& measured = *measured_[i];
    if (!measured.can_sample() || !measured.wants_sample()) continue;
    if (!budget_hit_ || measured.lacks_runs())
      rows.push_back(i);
    else
      measured.row.budget_hit = true;
  }
  return rows;
}

void SuiteRun::sample_rounds() {
  sampling_ = Clock::now();
  result_.opening_s = seconds_since(start_);
  Clock::time_point told = Clock::now();
  for (int round = 0;; ++round) {
    const std::vector<size_t> active = wanting();
    if (active.empty()) return;
    for (const size_t k : round_order(active.size(), items_.front().suite->sampling.order_seed, round)) {
      if (stopped()) return;
      Measured& measured = *measured_[active[k]];
      if (out_of_time() && !measured.lacks_runs()) continue;
      const auto file = store_.file_of(items_[active[k]].configuration);
      const auto sampled = file ? measured.sample(*file) : std::unexpected(file.error());
      if (!sampled) measured.fail_with(sampled.error());
    }
    if (seconds_since(told) > 5) {
      told = Clock::now();
      log::info("round {}: {} configurations, {:.0f} s so far", round + 1, active.size(), seconds_since(start_));
    }
  }
}

void SuiteRun::finish() {
  int capped = 0, unfinished = 0;
  for (auto& measured : measured_) {
    measured->finish();
    capped += measured->row.runs_capped;
    unfinished += measured->row.budget_hit;
    result_.rows.push_back(std::move(measured->row));
  }
  result_.wall_s = seconds_since(start_);
  if (capped > 0)
    result_.notes.push_back(
        fmt::format("{} configurations hit the cap on runs before the precision that was asked for", capped));
  if (budget_hit_)
    result_.notes.push_back(
        fmt::format("sampling took {:.3g} s, its time budget is {:g} s: {} of {} configurations have fewer runs than "
                    "their precision "
                    "needs",
                    result_.wall_s - result_.opening_s, budget_s_, unfinished, result_.rows.size()));
  if (result_.stopped) result_.notes.push_back("the run was stopped before its end");
  for (const std::string& note : result_.notes) log::warning("{}", note);
}

Expected<BenchRun> SuiteRun::run() {
  open_all();
  if (!stopped()) sample_rounds();
  finish();
  return std::move(result_);
}

}  // namespace

std::vector<std::string> rows_without_runs(const BenchRun& run) {
  std::vector<std::string> titles;
  for (const BenchRow& row : run.rows)
    if (row.left_out.empty() && row.frame.ms.empty()) titles.push_back(row_title(row));
  return titles;
}

Expected<BenchRun> run_items(const std::vector<RunItem>& items, double budget_s, const RunSettings& settings,
                             const std::function<bool()>& stop, const SeeFirstFrame& seen) {
  return SuiteRun(items, budget_s, settings, stop, seen).run();
}

Expected<BenchRun> run_suites(const std::vector<Suite>& suites, const RunSettings& settings,
                              const std::function<bool()>& stop) {
  std::vector<Item> items;
  for (const Suite& suite : suites) {
    auto all = configurations(suite);
    if (!all) return std::unexpected(all.error());
    for (Configuration& c : *all) {
      std::string group = picture_group(c, suite);
      items.push_back({&suite, std::move(c), std::move(group)});
    }
  }
  return SuiteRun(suites, std::move(items), settings, stop).run();
}

}  // namespace candela
