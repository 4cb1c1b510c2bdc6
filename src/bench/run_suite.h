#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench/row.h"
#include "bench/suite.h"

namespace candela {

// Rows and what a reader must know beside them.
struct BenchRun {
  std::vector<BenchRow> rows;
  std::vector<std::string> notes;  // time ran out, configurations reopened
  double wall_s = 0;
};

// Runs every configuration of the suites: opens it, renders it once and checks the picture, then takes samples in
// rounds over all configurations, so that a machine that slows down slows all alike. A configuration that fails is a
// row with an error; only what makes all fail is an error here. `stop` ends the run early; what was measured is kept.
Expected<BenchRun> run_suites(const std::vector<Suite>& suites, const RunSettings& settings,
                              const std::function<bool()>& stop);

}  // namespace candela
