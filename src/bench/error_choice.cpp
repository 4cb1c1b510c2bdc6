#include "bench/error_choice.h"

#include <charconv>
#include <set>

#include "base/text.h"
#include "bench/error_analysis.h"

namespace candela {
namespace {

struct Candidate {
  const BenchRow* row = nullptr;
  std::set<std::string> places;
  double ms = 0, error = 0;
};

Expected<SettingChoice> choice_of(const Candidate& candidate, const std::string& file) {
  const auto job = job_from_json(candidate.row->job);
  if (!job) return fail(ErrorKind::input, file, "the row of {} holds no job: {}", error_setting(*candidate.row), job.error().message);
  return SettingChoice{job->technique,  job->quality,           job->settings,
                       job->samples,    candidate.ms,           candidate.error,
                       candidate.row->device, error_setting(*candidate.row)};
}

}  // namespace

Expected<void> parse_error_budget(const std::string& text, ErrorBudget& budget) {
  static const std::vector<std::string> metrics = {"max", "mae", "rmse", "relmse", "relmse-trimmed", "p50", "p90", "p99", "p99.9", "flip", "hdr-flip", "differing"};
  const size_t equals = text.find('=');
  if (equals == std::string::npos)
    return fail(ErrorKind::usage, "--error-budget", "'{}' is not of the form METRIC=VALUE, for example relMSE=0.01", text);
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

Expected<SettingChoice> choose_setting(const std::vector<BenchRow>& rows, int width_px, int height_px, const ErrorBudget& budget,
                                       const std::string& file) {
  std::map<std::string, Candidate> settings;
  std::set<std::string> places, sizes;
  for (const BenchRow& row : rows) {
    const auto error = error_of(row, budget.reference, budget.metric);
    if (!error) continue;
    sizes.insert(fmt::format("{}x{}", row.width_px, row.height_px));
    if (row.width_px != width_px || row.height_px != height_px) continue;
    places.insert(error_place(row));
    Candidate& candidate = settings[error_setting(row)];
    candidate.row = &row;
    candidate.places.insert(error_place(row));
    candidate.ms = std::max(candidate.ms, summary(row.gpu.ms).median);
    candidate.error = std::max(candidate.error, *error);
  }
  if (sizes.empty())
    return fail(ErrorKind::input, file, "holds no {} against {}; candela bench --error makes such a file", budget.metric, budget.reference);
  if (places.empty())
    return fail(ErrorKind::input, file, "was not measured at {}x{} but at {}: times do not carry over", width_px, height_px,
                joined(std::vector<std::string>(sizes.begin(), sizes.end())));
  const Candidate *best = nullptr, *nearest = nullptr;
  for (const auto& [name, c] : settings) {
    if (c.places.size() != places.size()) continue;
    const auto order = [&](const Candidate& x) { return budget.time_ms ? std::pair(x.error, x.ms) : std::pair(x.ms, x.error); };
    const auto need = [&](const Candidate& x) { return budget.time_ms ? x.ms : x.error; };
    if (!nearest || need(c) < need(*nearest)) nearest = &c;
    if (need(c) <= (budget.time_ms ? *budget.time_ms : *budget.error) && (!best || order(c) < order(*best))) best = &c;
  }
  if (!nearest) return fail(ErrorKind::input, file, "no setting was measured in every place");
  if (!best && budget.time_ms)
    return fail(ErrorKind::usage, "--time-budget", "no setting takes {} ms or less; the quickest, {}, takes {:.3g} ms", *budget.time_ms,
                error_setting(*nearest->row), nearest->ms);
  if (!best)
    return fail(ErrorKind::usage, "--error-budget", "no setting has {} of {} or less against {}; the best, {}, has {:.3g}", budget.metric,
                *budget.error, budget.reference, error_setting(*nearest->row), nearest->error);
  return choice_of(*best, file);
}

}  // namespace candela
