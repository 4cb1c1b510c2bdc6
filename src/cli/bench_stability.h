#pragma once
#include "cli/bench_options.h"

namespace candela::cli {

// candela bench --suite stability: prints the table, writes JSON; exit code 1 when a row is not as it should be.
Expected<int> run_stability(const BenchOptions& options);

}  // namespace candela::cli
