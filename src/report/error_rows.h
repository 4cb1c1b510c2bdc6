#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/run_suite.h"

namespace candela {

// What sweeps of error against time add to files of rows (bench_rows.h).
nlohmann::ordered_json errors_json(const std::vector<PictureError>& errors);
std::vector<PictureError> errors_from(const nlohmann::ordered_json& json);  // throws nlohmann's exceptions
nlohmann::ordered_json knobs_json(const std::vector<KnobPoint>& knobs);
std::vector<KnobPoint> knobs_from(const nlohmann::ordered_json& json);  // the same

nlohmann::ordered_json same_work_json(const std::vector<SameWork>& all);
std::vector<SameWork> same_work_from(const nlohmann::ordered_json& json);  // the same

// Columns error.<reference>.<metric> and noise.<reference>.relmse that any row has, and a row's cells for them.
std::vector<std::string> error_columns(const BenchRun& run);
std::vector<std::string> error_cells(const BenchRow& row, const std::vector<std::string>& columns);

// What follows from the rows, by place: sentences, fronts, and knobs with their order of convergence; null without
// errors.
nlohmann::ordered_json error_findings_json(const BenchRun& run);

// Rows with errors by place, in the order of their first row.
struct ErrorPlace {
  std::string name;
  std::vector<const BenchRow*> rows;
};
std::vector<ErrorPlace> error_places(const BenchRun& run);

// Bounds that the sentences are about.
inline constexpr double error_bounds[] = {0.1, 0.01, 0.001, 0.0001};

}  // namespace candela
