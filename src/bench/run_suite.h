#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench/row.h"
#include "bench/suite.h"
#include "session/session.h"

namespace candela {

// Rows and what a reader must know beside them.
struct BenchRun {
  std::vector<BenchRow> rows;
  std::vector<std::string> notes;  // time ran out, configurations reopened
  double wall_s = 0;               // of all, opening_s among it
  double opening_s = 0;            // loading, first frames, checks of pictures and warm-up
  bool stopped = false;            // before its end
};
// Titles of rows that should have been measured and have no runs; what a suite leaves out is not among them.
std::vector<std::string> rows_without_runs(const BenchRun& run);

// Rows of configurations that were chosen one by one, in their order. Pictures are compared by `seen`, which gets each
// one's first frame of every view, one view after the other, and its row; they are not checked against a technique's,
// and lists of lights are not counted.
struct RunItem {
  const Suite* suite = nullptr;  // its name and what a timed frame leaves; the first one's sampling holds for all
  Configuration configuration;
};
using SeeFirstFrame = std::function<void(size_t item, BenchRow& row, const FrameResult& frame, const Session& session)>;
Expected<BenchRun> run_items(const std::vector<RunItem>& items, double budget_s, const RunSettings& settings,
                             const std::function<bool()>& stop, const SeeFirstFrame& seen);

// Runs every configuration of the suites: opens it, renders it once and checks the picture, then takes samples in
// rounds over all configurations, so that a machine that slows down slows all alike. A configuration that fails is a
// row with an error; only what makes all fail is an error here. `stop` ends the run early; what was measured is kept.
// A budget is of sampling: opening has its own time, and every row gets its least number of runs, however long.
Expected<BenchRun> run_suites(const std::vector<Suite>& suites, const RunSettings& settings,
                              const std::function<bool()>& stop);

}  // namespace candela
