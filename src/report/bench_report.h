#pragma once
#include <string>

#include "bench/run_suite.h"

namespace candela {

// One HTML page without other files. Rows share axes only when all but the number of lights and the technique agree,
// the device first of all. plots: draw with gnuplot; without it the page says so and has the tables alone.
std::string bench_html(const BenchRun& run, const std::string& title, bool plots);

}  // namespace candela
