#include "report/error_rows.h"

#include <set>

#include "bench/error_analysis.h"
#include "bench/error_truth.h"

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
                           {"rmse", v.rmse},
                           {"dominated", v.dominated},
                           {"verdict", v.verdict}});
  return j;
}

std::string column_of(const std::string& reference, const std::string& metric) {
  return "error." + reference + "." + metric;
}

}  // namespace

Json errors_json(const std::vector<PictureError>& errors) {
  Json all = Json::array();
  for (const PictureError& error : errors) {
    Json j = {{"reference", error.reference}, {"metrics", Json::object()}};
    for (const auto& [name, value] : error.metrics) j["metrics"][name] = std::isfinite(value) ? Json(value) : Json();
    if (error.noise) j["noise_floor"] = {{"rmse", error.noise->rmse}, {"relmse", error.noise->relmse}};
    if (error.exposures)
      j["hdr_flip_exposures"] = {
          {"start", error.exposures->start}, {"stop", error.exposures->stop}, {"count", error.exposures->count}};
    if (error.spp > 0) j["spp"] = error.spp;
    if (!error.note.empty()) j["note"] = error.note;
    all.push_back(std::move(j));
  }
  return all;
}

std::vector<PictureError> errors_from(const Json& json) {
  std::vector<PictureError> errors;
  for (const Json& j : json) {
    PictureError& error = errors.emplace_back();
    error.reference = j.at("reference");
    for (const auto& [name, value] : j.at("metrics").items())
      error.metrics[name] = value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
    if (j.contains("noise_floor")) error.noise = NoiseFloor{j["noise_floor"].at("rmse"), j["noise_floor"].at("relmse")};
    if (j.contains("hdr_flip_exposures")) {
      const Json& e = j["hdr_flip_exposures"];
      error.exposures = ExposureRange{e.at("start"), e.at("stop"), e.at("count")};
    }
    error.spp = j.value("spp", uint64_t(0));
    error.note = j.value("note", "");
  }
  return errors;
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
    Json j = {{"place", place.name},
              {"cheapest", Json::array()},
              {"fronts", Json::array()},
              {"total", Json::array()},
              {"noise", Json::array()},
              {"knobs", Json::array()},
              {"defects", error_defects(place.rows)}};
    for (const std::string& reference : error_reference_names()) {
      for (const double bound : error_bounds) {
        const BenchRow* row = cheapest(place.rows, reference, "relmse", bound);
        j["cheapest"].push_back({{"reference", reference},
                                 {"metric", "relmse"},
                                 {"below", bound},
                                 {"setting", row ? Json(error_setting(*row)) : Json()},
                                 {"sentence", cheapest_sentence(place.rows, reference, "relmse", bound)}});
      }
      for (const TotalError& t : total_errors(place.rows, reference))
        if (reference != exact_reference)
          j["total"].push_back({{"reference", reference},
                                {"technique", t.row->technique},
                                {"quality", t.row->quality},
                                {"relmse", t.total},
                                {"model_relmse", t.model},
                                {"sampling_relmse", t.sampling}});
      Json front = Json::array();
      for (const ErrorPoint& point : error_points(place.rows, reference, "relmse"))
        if (!point.dominated)
          front.push_back({{"setting", error_setting(*point.row)},
                           {"gpu_ms", point.ms},
                           {"gpu_ci95_ms", {point.ms_ci.low, point.ms_ci.high}},
                           {"relmse", point.error}});
      j["fronts"].push_back({{"reference", reference}, {"metric", "relmse"}, {"points", std::move(front)}});
    }
    for (const NoiseVerdict& v : noise_verdicts(place.rows))
      j["noise"].push_back({{"reference", v.reference},
                            {"spp", v.spp},
                            {"relmse", v.floor},
                            {"smallest_error", v.smallest},
                            {"below_a_tenth", v.enough},
                            {"sentence", v.sentence}});
    for (const KnobStudy& study : knob_studies(place.rows)) j["knobs"].push_back(knob_json(study));
    all.push_back(std::move(j));
  }
  return all.empty() ? Json() : all;
}

}  // namespace candela
