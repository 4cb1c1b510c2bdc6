#include "bench/error_choice.h"

#include <charconv>
#include <set>

#include "base/text.h"
#include "bench/error_analysis.h"

namespace candela {
namespace {

Expected<SettingChoice> choice_of(const SettingPoint& s, const std::string& file) {
  const auto job = job_from_json(s.row->job);
  if (!job)
    return fail(ErrorKind::input, file, "the row of {} holds no job: {}", error_setting(*s.row), job.error().message);
  return SettingChoice{job->technique, job->quality, job->settings, job->samples,         s.ms,
                       s.error,        s.ms_ci,      s.error_ci,    error_setting(*s.row)};
}

// Those rows that are about the place, or why there are none.
Expected<std::vector<const BenchRow*>> rows_of_place(const std::vector<BenchRow>& rows, const BudgetPlace& place,
                                                     const ErrorBudget& budget, const std::string& file) {
  std::vector<const BenchRow*> left;
  for (const BenchRow& row : rows)
    if (error_of(row, budget.reference, budget.metric)) left.push_back(&row);
  if (left.empty())
    return fail(ErrorKind::input, file, "holds no {} against {}; candela bench --error makes such a file",
                budget.metric, budget.reference);
  // Keeps what `fits`; names what there is instead, and why that does not help.
  const auto narrow = [&](auto&& fits, auto&& name_of, const std::string& wanted, const char* why) -> Expected<void> {
    std::set<std::string> there;
    for (const BenchRow* row : left) there.insert(name_of(*row));
    std::erase_if(left, [&](const BenchRow* row) { return !fits(*row); });
    if (!left.empty()) return {};
    return fail(ErrorKind::input, file, "was not measured {} but {}: {}", wanted,
                joined(std::vector<std::string>(there.begin(), there.end())), why);
  };
  if (auto some =
          narrow([&](const BenchRow& row) { return row.scene_content == place.scene_content; },
                 [](const BenchRow& row) { return "with " + row.scene; }, "with the content of " + place.scene,
                 "neither times nor errors carry over from scene to scene; run candela bench --error on this one");
      !some)
    return std::unexpected(some.error());
  if (auto some = narrow(
          [&](const BenchRow& row) { return row.width_px == place.width_px && row.height_px == place.height_px; },
          [](const BenchRow& row) { return fmt::format("at {}x{}", row.width_px, row.height_px); },
          fmt::format("at {}x{}", place.width_px, place.height_px), "times do not carry over from size to size");
      !some)
    return std::unexpected(some.error());
  if (auto some = narrow([&](const BenchRow& row) { return row.device == place.device; },
                         [](const BenchRow& row) { return "on " + row.device; }, "on " + place.device,
                         "times do not carry over from device to device");
      !some)
    return std::unexpected(some.error());
  return left;
}

}  // namespace

Expected<void> parse_error_budget(const std::string& text, ErrorBudget& budget) {
  static const std::vector<std::string> metrics = {"max", "mae", "rmse",  "relmse", "relmse-trimmed", "p50",
                                                   "p90", "p99", "p99.9", "flip",   "hdr-flip",       "differing"};
  const size_t equals = text.find('=');
  if (equals == std::string::npos)
    return fail(ErrorKind::usage, "--error-budget", "'{}' is not of the form METRIC=VALUE, for example relMSE=0.01",
                text);
  std::string metric = text.substr(0, equals);
  std::transform(metric.begin(), metric.end(), metric.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (std::find(metrics.begin(), metrics.end(), metric) == metrics.end())
    return fail(ErrorKind::usage, "--error-budget", "{}", unknown_name("metric", metric, metrics));
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + equals + 1, end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || !(value >= 0) || !std::isfinite(value))
    return fail(ErrorKind::usage, "--error-budget", "the value of '{}' is not a number of at least 0", text);
  budget.metric = metric;
  budget.error = value;
  return {};
}

Expected<SettingChoice> choose_setting(const std::vector<BenchRow>& all, const BudgetPlace& place,
                                       const ErrorBudget& budget, const std::string& file) {
  const auto rows = rows_of_place(all, place, budget, file);
  if (!rows) return std::unexpected(rows.error());
  const std::vector<SettingPoint> settings = setting_points(*rows, budget.reference, budget.metric);
  if (settings.empty())
    return fail(ErrorKind::input, file, "no setting was measured with every camera and at every time");
  const SettingPoint* best = budget.time_ms ? most_exact(settings, *budget.time_ms, budget.reference, budget.metric)
                                            : cheapest(settings, *budget.error);
  const auto need = [&](const SettingPoint& s) { return budget.time_ms ? s.ms_ci.high : s.error_ci.high; };
  const SettingPoint& nearest = *std::min_element(settings.begin(), settings.end(),
                                                  [&](const auto& a, const auto& b) { return need(a) < need(b); });
  if (!best && budget.time_ms)
    return fail(
        ErrorKind::usage, "--time-budget",
        "no setting is sure to take {} ms or less; the quickest, {}, takes {:.3g} ms (95 % CI {:.3g} to {:.3g})",
        *budget.time_ms, error_setting(*nearest.row), nearest.ms, nearest.ms_ci.low, nearest.ms_ci.high);
  if (!best)
    return fail(ErrorKind::usage, "--error-budget",
                "no setting is sure to have {} of {} or less against {}; the best, {}, has {:.3g} (95 % CI {:.3g} to "
                "{:.3g})",
                budget.metric, *budget.error, budget.reference, error_setting(*nearest.row), nearest.error,
                nearest.error_ci.low, nearest.error_ci.high);
  return choice_of(*best, file);
}

}  // namespace candela
