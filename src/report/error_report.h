#pragma once
#include <string>

#include "bench/run_suite.h"
#include "report/figures.h"

namespace candela {

// The sections of a report that a sweep of error against time adds; empty where no row has errors.
// Its figures are added to `figures`.
std::string error_html(const BenchRun& run, Figures& figures);

}  // namespace candela
