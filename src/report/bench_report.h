#pragma once
#include <string>

#include "bench/run_suite.h"
#include "report/plot.h"

namespace candela {

// One HTML page without other files. Rows share axes only when all but the number of lights and the technique agree,
// the device first of all. plots: draw with gnuplot; without it the page says so and has the tables alone.
// Findings first, what was noted on the way folded at the end. figures: takes each figure of the page.
std::string bench_html(const BenchRun& run, const std::string& title, bool plots, FigureFiles* figures = nullptr);

}  // namespace candela
