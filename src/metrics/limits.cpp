#include "metrics/limits.h"

#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

namespace candela {
namespace {

constexpr std::array<std::string_view, 8> metric_names = {"max",  "mae",  "rmse", "relmse",
                                                          "psnr", "ssim", "flip", "differing"};
bool is_lower_bound(std::string_view metric) { return metric == "psnr" || metric == "ssim"; }

}  // namespace

Expected<Limit> parse_limit(std::string_view text) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    return fail(ErrorKind::usage, {}, "limit \"{}\" is not of the form METRIC=VALUE, for example flip=0.02", text);
  Limit limit{std::string(text.substr(0, equals)), 0};
  if (std::find(metric_names.begin(), metric_names.end(), limit.metric) == metric_names.end())
    return fail(ErrorKind::usage, {}, "unknown metric \"{}\"; use one of {}", limit.metric,
                fmt::join(metric_names, ", "));
  const std::string_view value = text.substr(equals + 1);
  const auto parsed = std::from_chars(value.data(), value.data() + value.size(), limit.value);
  if (parsed.ec != std::errc() || parsed.ptr != value.data() + value.size() || !std::isfinite(limit.value))
    return fail(ErrorKind::usage, {}, "the value of limit \"{}\" is not a number", text);
  return limit;
}

std::vector<LimitVerdict> judge_limits(const Comparison& comparison, std::span<const Limit> limits) {
  std::vector<LimitVerdict> verdicts;
  for (const Limit& limit : limits) {
    const auto found = comparison.metrics.find(limit.metric);
    const double measured =
        found == comparison.metrics.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
    // Both comparisons are false for NaN: a metric that is not there fails.
    verdicts.push_back(
        {limit, measured, is_lower_bound(limit.metric) ? measured >= limit.value : measured <= limit.value});
  }
  return verdicts;
}

bool passes(const Comparison& comparison, std::span<const LimitVerdict> verdicts) {
  return comparison.refusal.empty() &&
         std::all_of(verdicts.begin(), verdicts.end(), [](const LimitVerdict& v) { return v.pass; });
}

std::string comparison_json(const Comparison& comparison, std::span<const LimitVerdict> verdicts) {
  nlohmann::ordered_json json;
  json["metrics"] = nlohmann::ordered_json::object();
  for (const auto& [name, value] : comparison.metrics) {
    if (name == "differing")
      json["metrics"][name] = uint64_t(value);
    else
      json["metrics"][name] = value;
  }
  json["pass"] = passes(comparison, verdicts);
  for (const LimitVerdict& v : verdicts)
    json["limits"].push_back({{"metric", v.limit.metric}, {"limit", v.limit.value}, {"pass", v.pass}});
  if (!comparison.refusal.empty()) json["refusal"] = comparison.refusal;
  return json.dump(2);
}

}  // namespace candela
