#pragma once
#include <string>

#include "bench/run_suite.h"
#include "report/figures.h"

namespace candela {

// One HTML page without other files: findings, device, program and a picture of the scene first; figures; tables; notes
// folded. Rows share axes only when all but the number of lights and the technique agree, the device first of all.
// Without gnuplot the page says so and has the tables alone. figures: takes each figure of the page.
std::string bench_html(const BenchRun& run, const std::string& title, Figures& figures);

}  // namespace candela
