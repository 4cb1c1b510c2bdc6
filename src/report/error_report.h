#pragma once
#include <string>

#include "bench/run_suite.h"

namespace candela {

// The sections of a report that a sweep of error against time adds; empty where no row has errors.
std::string error_html(const BenchRun& run);

}  // namespace candela
