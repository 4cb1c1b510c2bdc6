#include "metrics/limits.h"

#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace candela {
namespace {

constexpr std::array<std::string_view, 14> metric_names = {"max",  "mae",  "rmse",     "relmse",   "relmse-trimmed",
                                                           "p50",  "p90",  "p99",      "p99.9",    "psnr",
                                                           "ssim", "flip", "hdr-flip", "differing"};
bool is_lower_bound(std::string_view metric) { return metric == "psnr" || metric == "ssim"; }

}  // namespace

Expected<Limit> parse_limit(std::string_view text) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    return fail(ErrorKind::usage, {}, "limit \"{}\" is not of the form METRIC=VALUE, for example flip=0.02", text);
  Limit limit{std::string(text.substr(0, equals)), 0};
  if (std::find(metric_names.begin(), metric_names.end(), limit.metric) == metric_names.end())
    return fail(
        ErrorKind::usage, "--limit", "{}",
        unknown_name("metric", limit.metric, std::vector<std::string>(metric_names.begin(), metric_names.end())));
  const std::string_view value = text.substr(equals + 1);
  const auto parsed = std::from_chars(value.data(), value.data() + value.size(), limit.value);
  if (parsed.ec != std::errc() || parsed.ptr != value.data() + value.size() || !std::isfinite(limit.value))
    return fail(ErrorKind::usage, {}, "the value of limit \"{}\" is not a number", text);
  return limit;
}

std::vector<LimitVerdict> judge_limits(const Comparison& comparison, std::span<const Limit> limits) {
  std::vector<LimitVerdict> verdicts;
  for (const Limit& limit : limits) {
    const auto judge = [&](const std::map<std::string, double>& metrics, std::string region) {
      const auto found = metrics.find(limit.metric);
      const double measured = found == metrics.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
      // Both comparisons are false for NaN: a metric that is not there fails.
      const bool pass = is_lower_bound(limit.metric) ? measured >= limit.value : measured <= limit.value;
      verdicts.push_back({limit, measured, pass, std::move(region)});
    };
    judge(comparison.metrics, "");
    for (const RegionResult& region : comparison.regions) judge(region.metrics, region.region.text());
  }
  return verdicts;
}

bool passes(const Comparison& comparison, std::span<const LimitVerdict> verdicts) {
  return comparison.refusal.empty() &&
         std::all_of(verdicts.begin(), verdicts.end(), [](const LimitVerdict& v) { return v.pass; });
}

namespace {

using Json = nlohmann::ordered_json;

Json metrics_json(const std::map<std::string, double>& metrics) {
  Json json = Json::object();
  for (const auto& [name, value] : metrics) {
    if (name == "differing" || name == "one-sided")
      json[name] = uint64_t(value);
    else
      json[name] = value;
  }
  return json;
}

void add_place(Json& json, const Place& place) {
  if (!place.channel.empty()) json["max_at"] = {{"x", place.x}, {"y", place.y}, {"channel", place.channel}};
}

void add_noise(Json& json, const std::optional<NoiseFloor>& noise, const std::map<std::string, double>& metrics) {
  if (!noise) return;
  Json& floor = json["noise_floor"] = {{"rmse", noise->rmse}, {"relmse", noise->relmse}};
  floor["below"] = Json::array();
  for (const std::string& metric : below_noise(metrics, *noise)) floor["below"].push_back(metric);
}

}  // namespace

std::vector<std::string> below_noise(const std::map<std::string, double>& metrics, const NoiseFloor& noise) {
  std::vector<std::string> below;
  for (const auto& [name, floor] : {std::pair("rmse", noise.rmse), std::pair("relmse", noise.relmse)})
    if (const auto found = metrics.find(name); found != metrics.end() && found->second <= floor) below.push_back(name);
  return below;
}

std::string comparison_json(const Comparison& comparison, std::span<const LimitVerdict> verdicts) {
  Json json;
  json["nonfinite"] = {{"reference", comparison.nonfinite_reference},
                       {"test", comparison.nonfinite_test},
                       {"equal_values", comparison.nonfinite_in_both}};
  json["metrics"] = metrics_json(comparison.metrics);
  json["pass"] = passes(comparison, verdicts);
  json["relmse_epsilon"] = relmse_epsilon;
  json["trimmed_share"] = trimmed_fraction;
  add_place(json, comparison.max_at);
  if (comparison.exposures)
    json["hdr_flip_exposures"] = {{"start", comparison.exposures->start},
                                  {"stop", comparison.exposures->stop},
                                  {"count", comparison.exposures->count}};
  add_noise(json, comparison.noise, comparison.metrics);
  for (const LimitVerdict& v : verdicts) {
    Json limit = {{"metric", v.limit.metric}, {"limit", v.limit.value}, {"pass", v.pass}};
    if (!v.region.empty()) limit["region"] = v.region;
    json["limits"].push_back(std::move(limit));
  }
  for (const LayerResult& layer : comparison.layers) {
    Json j = {{"name", layer.name}, {"kind", layer_kind_name(layer.kind)}, {"metrics", metrics_json(layer.metrics)}};
    add_place(j, layer.max_at);
    json["layers"].push_back(std::move(j));
  }
  for (const RegionResult& region : comparison.regions) {
    Json j = {{"region", region.region.text()}, {"metrics", metrics_json(region.metrics)}};
    add_place(j, region.max_at);
    add_noise(j, region.noise, region.metrics);
    json["regions"].push_back(std::move(j));
  }
  for (const SharedLevels& levels : comparison.shared_levels)
    json["shared_levels"].push_back({{"layer", levels.layer},
                                     {"reference", levels.reference},
                                     {"test", levels.test},
                                     {"compared", levels.shared()}});
  if (!comparison.notes.empty()) json["notes"] = comparison.notes;
  if (!comparison.only_in_reference.empty()) json["only_in_reference"] = comparison.only_in_reference;
  if (!comparison.only_in_test.empty()) json["only_in_test"] = comparison.only_in_test;
  if (!comparison.refusal.empty()) json["refusal"] = comparison.refusal;
  return json.dump(2);
}

}  // namespace candela
