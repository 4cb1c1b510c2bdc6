#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/run_suite.h"

namespace candela {

// Of each scene, camera, size and moment the row with the most lights whose picture is there: the report shows it.
std::vector<const BenchRow*> rows_of_scene_pictures(const BenchRun& run);
// The file of --json: notes, and a row a configuration with raw samples and their statistics. Of pictures it holds
// those of the scenes (rows_of_scene_pictures) alone.
nlohmann::ordered_json bench_json(const BenchRun& run);
// Reads it back. Errors (input) name the file and the place.
Expected<BenchRun> read_bench_rows(const std::filesystem::path& file);

// One line a row, RFC 4180; columns gpu.<pass>_ms hold medians, empty where a row does not run the pass.
std::string bench_csv(const BenchRun& run);

nlohmann::ordered_json comparison_json(const RowComparison& comparison);

}  // namespace candela
