#pragma once
#include <functional>
#include <vector>

#include "bench/error_sweep.h"
#include "bench/scene_store.h"
#include "bench/sweep_places.h"

namespace candela {

// Error against time at one place of a sweep, in one session whose settings change (error_sweep.h says in which order).
// place: planned by sweep_places(), or, within a budget, of whole_places(). budget_s: of all of it, opening and traced
// references too; 0: none. progress gets the rows so far after each one and after each round. A row that fails is a row
// with an error.
Expected<BenchRun> run_error_place(SweepPlace place, const ErrorSweepOptions& options, double budget_s,
                                   SceneStore& store, const RunSettings& settings, const std::function<bool()>& stop,
                                   const std::function<void(const std::vector<BenchRow>&)>& progress);

}  // namespace candela
