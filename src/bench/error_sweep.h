#pragma once
#include <functional>

#include "bench/error_truth.h"
#include "bench/run_suite.h"

namespace candela {

// Error against time: every knob along its ladder with all else at its exact end, whose errors are the knob's own, and
// every technique at every quality as a whole (sweep_places.h).
struct ErrorSweepOptions {
  Suite base;  // scenes, lights, sizes, times, techniques and sampling; its knobs and qualities are not asked
  TruthLimits truth;
  std::optional<ExposureRange> exposures;  // of hdr-flip; nullopt: from the traced reference of each place
  std::vector<BenchRow> kept;              // of an earlier run: they stay, and are not measured again
};

// Rows of all places, each with an error against each reference over the place's views.
//
// Without a budget: everything, exact ends first; rows of one place are measured in interleaved rounds, each sample a
// frame of every view. With Suite::budget_s, which holds for all of it: in the order of use, until the time is over.
// First the chosen technique's qualities, against the one traced reference that holds what it draws; then its knobs a
// step from quality high, those that carry most error first, as small pictures show (error_screen.h); then the other
// techniques; then the exact ends and the knobs' sweeps. Each row is timed when it is opened, beside the first row,
// which is measured again and again; what time is left goes into rounds. A frame that was begun is finished.
//
// progress gets all rows so far after each one.
Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop,
                                   const std::function<void(const BenchRun&)>& progress = {});

}  // namespace candela
