#include "report/error_rows.h"

#include <set>

#include "base/json.h"
#include "bench/error_analysis.h"
#include "bench/error_truth.h"
#include "bench/error_views.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

Json knob_json(const KnobStudy& study) {
  Json j = {{"knob", study.knob},     {"technique", study.technique}, {"trades", study.kind},
            {"passes", study.passes}, {"advised", study.advised},     {"order", nullptr},
            {"values", Json::array()}};
  if (study.fit.points >= 2)
    j["order"] = {{"metric", "rmse"},
                  {"exponent", study.fit.exponent},
                  {"factor", study.fit.factor},
                  {"r_squared", study.r_squared},
                  {"points", study.fit.points}};
  for (const KnobStudy::Value& v : study.values)
    j["values"].push_back({{"value", v.text},
                           {"gpu_ms", v.ms},
                           {"gpu_ci95_ms", {v.ms_ci.low, v.ms_ci.high}},
                           {"passes_ms", v.passes_ms},
                           {"passes_ci95_ms", {v.passes_ci.low, v.passes_ci.high}},
                           {"frame_bytes", memory_of(*v.row, "frame_bytes")},
                           {"relmse", v.relmse},
                           {"relmse_ci95", {v.relmse_ci.low, v.relmse_ci.high}},
                           {"rmse", v.rmse},
                           {"dominated", v.dominated},
                           {"verdict", v.verdict}});
  return j;
}

std::vector<const BenchRow*> pointers(const std::vector<BenchRow>& rows) {
  std::vector<const BenchRow*> all;
  for (const BenchRow& row : rows) all.push_back(&row);
  return all;
}

std::string column_of(const std::string& reference, const std::string& metric) {
  return "error." + reference + "." + metric;
}

}  // namespace

namespace {

Json metrics_json(const std::map<std::string, double>& metrics) {
  Json j = Json::object();
  for (const auto& [name, value] : metrics) j[name] = std::isfinite(value) ? Json(value) : Json();
  return j;
}
std::map<std::string, double> metrics_from(const Json& json) {
  std::map<std::string, double> metrics;
  for (const auto& [name, value] : json.items())
    metrics[name] = value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
  return metrics;
}

Json noise_json(const NoiseFloor& noise) {
  return {{"rmse", noise.rmse}, {"relmse", noise.relmse}, {"relmse_sd", noise.relmse_sd}};
}
NoiseFloor noise_from(const Json& json) { return {json.at("rmse"), json.at("relmse"), json.value("relmse_sd", 0.0)}; }

Json error_json(const PictureError& error) {
  Json j = {{"reference", error.reference}, {"metrics", metrics_json(error.metrics)}};
  if (error.metrics.contains("relmse")) {
    const Interval ci = error_interval(error, "relmse");
    j["relmse_ci95"] = {ci.low, ci.high};
  }
  if (error.noise) j["noise_floor"] = noise_json(*error.noise);
  if (error.exposures)
    j["hdr_flip_exposures"] = {
        {"start", error.exposures->start}, {"stop", error.exposures->stop}, {"count", error.exposures->count}};
  if (error.spp > 0) j["spp"] = error.spp;
  if (!error.note.empty()) j["note"] = error.note;
  for (const ViewError& view : error.views) {
    Json v = {{"metrics", metrics_json(view.metrics)}};
    if (view.noise) v["noise_floor"] = noise_json(*view.noise);
    j["views"].push_back(std::move(v));
  }
  return j;
}

PictureError error_from(const Json& j) {
  PictureError error{.reference = j.at("reference"), .metrics = metrics_from(j.at("metrics"))};
  if (j.contains("noise_floor")) error.noise = noise_from(j["noise_floor"]);
  if (j.contains("hdr_flip_exposures")) {
    const Json& e = j["hdr_flip_exposures"];
    error.exposures = ExposureRange{e.at("start"), e.at("stop"), e.at("count")};
  }
  error.spp = j.value("spp", uint64_t(0));
  error.note = j.value("note", "");
  for (const Json& v : j.value("views", Json::array())) {
    ViewError& view = error.views.emplace_back();
    view.metrics = metrics_from(v.at("metrics"));
    if (v.contains("noise_floor")) view.noise = noise_from(v["noise_floor"]);
  }
  return error;
}

}  // namespace

Json errors_json(const std::vector<PictureError>& errors) {
  Json all = Json::array();
  for (const PictureError& error : errors) all.push_back(error_json(error));
  return all;
}

std::vector<PictureError> errors_from(const Json& json) {
  std::vector<PictureError> errors;
  for (const Json& j : json) errors.push_back(error_from(j));
  return errors;
}

Json same_work_json(const std::vector<SameWork>& all) {
  Json list = Json::array();
  for (const SameWork& same : all) {
    Json j = {{"suite", same.suite},
              {"technique", same.technique},
              {"quality", same.quality},
              {"settings", same.settings},
              {"job", same.job.empty() ? Json() : own_json(same.job)}};
    if (!same.knobs.empty()) j["knobs"] = knobs_json(same.knobs);
    if (same.exact) j["exact"] = error_json(*same.exact);
    list.push_back(std::move(j));
  }
  return list;
}

std::vector<SameWork> same_work_from(const Json& json) {
  std::vector<SameWork> all;
  for (const Json& j : json) {
    SameWork& same = all.emplace_back(
        SameWork{j.at("suite"), j.at("technique"), j.at("quality"), j.at("settings"), j.at("job").dump(), {}, {}});
    if (j.contains("knobs")) same.knobs = knobs_from(j["knobs"]);
    if (j.contains("exact")) same.exact = error_from(j["exact"]);
  }
  return all;
}

Json knobs_json(const std::vector<KnobPoint>& knobs) {
  Json all = Json::array();
  for (const KnobPoint& point : knobs)
    all.push_back({{"knob", point.knob}, {"value", point.value}, {"trades", point.kind}, {"passes", point.passes}});
  return all;
}

std::vector<KnobPoint> knobs_from(const Json& json) {
  std::vector<KnobPoint> knobs;
  for (const Json& j : json)
    knobs.push_back({j.at("knob"), j.at("value"), j.at("trades"), j.at("passes").get<std::vector<std::string>>()});
  return knobs;
}

std::vector<std::string> error_columns(const BenchRun& run) {
  std::vector<std::string> columns;
  std::set<std::string> seen;
  const auto add = [&](std::string column) {
    if (seen.insert(column).second) columns.push_back(std::move(column));
  };
  for (const BenchRow& row : run.rows)
    for (const PictureError& error : row.errors) {
      for (const auto& [metric, value] : error.metrics) add(column_of(error.reference, metric));
      if (error.noise) add("noise." + error.reference + ".relmse");
    }
  return columns;
}

std::vector<std::string> error_cells(const BenchRow& row, const std::vector<std::string>& columns) {
  std::map<std::string, double> values;
  for (const PictureError& error : row.errors) {
    for (const auto& [metric, value] : error.metrics) values[column_of(error.reference, metric)] = value;
    if (error.noise) values["noise." + error.reference + ".relmse"] = error.noise->relmse;
  }
  std::vector<std::string> cells;
  for (const std::string& column : columns) {
    const auto found = values.find(column);
    cells.push_back(found == values.end() ? std::string() : fmt::format("{}", found->second));
  }
  return cells;
}

std::vector<ErrorPlace> error_places(const BenchRun& run) {
  std::vector<ErrorPlace> places;
  for (const BenchRow& row : run.rows) {
    if (row.errors.empty()) continue;
    const std::string name = error_place(row);
    const auto found = std::find_if(places.begin(), places.end(), [&](const ErrorPlace& p) { return p.name == name; });
    (found == places.end() ? places.emplace_back(ErrorPlace{name, {}}) : *found).rows.push_back(&row);
  }
  return places;
}

Json error_findings_json(const BenchRun& run) {
  Json all = Json::array();
  for (const ErrorPlace& place : error_places(run)) {
    Json j = {{"place", place.name},       {"truth", truth_of(place.rows)},
              {"cheapest", Json::array()}, {"fronts", Json::array()},
              {"total", Json::array()},    {"noise", Json::array()},
              {"knobs", Json::array()},    {"defects", error_defects(place.rows)}};
    const std::vector<BenchRow> named = rows_by_name(place.rows);
    const std::vector<const BenchRow*> by_name = pointers(named);
    for (const std::string& reference : error_reference_names()) {
      const std::vector<SettingPoint> settings = setting_points(place.rows, reference, "relmse");
      for (const double bound : error_bounds) {
        if (settings.empty()) continue;
        const SettingPoint* s = cheapest(settings, bound);
        j["cheapest"].push_back({{"reference", reference},
                                 {"metric", "relmse"},
                                 {"below", bound},
                                 {"setting", s ? Json(error_setting(*s->row)) : Json()},
                                 {"sentence", cheapest_sentence(place.rows, reference, "relmse", bound)}});
      }
      for (const TotalError& t : total_errors(by_name, reference))
        if (reference != exact_reference)
          j["total"].push_back({{"reference", reference},
                                {"technique", t.row->technique},
                                {"quality", t.row->quality},
                                {"relmse", t.total},
                                {"model_relmse", t.model},
                                {"sampling_relmse", t.sampling}});
      Json front = Json::array();
      for (const ErrorPoint& point : error_points(place.rows, reference, "relmse")) {
        if (point.standing == ErrorPoint::Standing::dominated) continue;
        front.push_back({{"setting", error_setting(*point.row)},
                         {"gpu_ms", point.ms},
                         {"gpu_ci95_ms", {point.ms_ci.low, point.ms_ci.high}},
                         {"relmse", point.error},
                         {"relmse_ci95", {point.error_ci.low, point.error_ci.high}},
                         {"standing", standing_name(point.standing)}});
        if (point.by) front.back()["from"] = error_setting(*point.by);
      }
      j["fronts"].push_back({{"reference", reference}, {"metric", "relmse"}, {"points", std::move(front)}});
    }
    for (const NoiseVerdict& v : noise_verdicts(place.rows))
      j["noise"].push_back({{"reference", v.reference},
                            {"spp", v.spp},
                            {"relmse", v.floor},
                            {"smallest_error", v.smallest},
                            {"below_a_tenth", v.enough},
                            {"sentence", v.sentence}});
    for (const KnobStudy& study : knob_studies(by_name)) j["knobs"].push_back(knob_json(study));
    all.push_back(std::move(j));
  }
  return all.empty() ? Json() : all;
}

}  // namespace candela
