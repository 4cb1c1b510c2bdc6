#pragma once
#include <functional>

#include "bench/run_suite.h"

namespace candela {

// Error against time: every knob along its ladder with all else at its exact end, whose errors are the knob's own, and every technique
// at every quality as a whole.
struct ErrorSweepOptions {
  Suite base;                   // scenes, lights, sizes, times, techniques and sampling; its knobs and qualities are not asked
  uint64_t reference_spp = 64;  // of each traced reference
  double reference_s = 0;       // longest time for one; 0: none
  std::optional<ExposureRange> exposures;  // of hdr-flip; nullopt: from the first reference of each place
};

// What pictures are compared with. `exact` is the first technique at quality exact, on the GPU: a difference from it is what knobs leave
// wrong. The others are traced: `direct-unshadowed` shows what GPU techniques without shadows approximate, `direct` blocks light by what
// stands in its way, `path` has indirect light besides.
inline constexpr const char* exact_reference = "exact";
inline constexpr const char* open_reference_name = "direct-unshadowed";
std::vector<std::string> error_reference_names();

// Suite "whole", and a suite "knob PASS.KNOB" for each knob whose ladder has more than one rung.
std::vector<Suite> error_suites(const Suite& base);

// Rows of all these suites, in one run of interleaved rounds, each with an error against each reference.
Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings, const std::function<bool()>& stop);

}  // namespace candela
