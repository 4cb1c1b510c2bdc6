#pragma once
#include <vector>

#include "bench/run_suite.h"
#include "report/page.h"

namespace candela {

// Rows that may share axes (row_axis), in the order of their first row; only measured ones.
struct BenchAxis {
  std::string name;
  std::vector<const BenchRow*> rows;
};
std::vector<BenchAxis> axes_of(const BenchRun& run);

// What follows from the times and pictures of the rows, as sentences: which technique is the quickest where there are
// most lights, decided on the differences of the same rounds; how times grow; whether the pictures agree.
std::vector<PageFinding> bench_findings(const BenchRun& run);
// The same of a sweep of error against time: the cheapest setting for some errors.
std::vector<PageFinding> error_findings(const BenchRun& run);

}  // namespace candela
