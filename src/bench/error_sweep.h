#pragma once
#include <functional>

#include "bench/error_truth.h"
#include "bench/run_suite.h"

namespace candela {

// Error against time: every knob along its ladder with all else at its exact end, whose errors are the knob's own, and
// every technique at every quality as a whole (error_walk.h).
struct ErrorSweepOptions {
  Suite base;  // scenes, lights, sizes, times, techniques and sampling; its knobs and qualities are not asked
  TruthLimits truth;
  std::optional<ExposureRange> exposures;  // of hdr-flip; nullopt: from the first traced reference of each place
};

// Rows of all places, each with an error against each reference over the place's views; those of one place are measured
// in interleaved rounds, each sample a frame of every view.
Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop);

}  // namespace candela
