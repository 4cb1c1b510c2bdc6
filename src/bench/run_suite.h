#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench/row.h"
#include "bench/suite.h"
#include "frame/session.h"

namespace candela {

// Rows and what a reader must know beside them.
struct BenchRun {
  std::vector<BenchRow> rows;
  std::vector<std::string> notes;  // time ran out, configurations reopened
  double wall_s = 0;
};

// Rows of configurations that were chosen one by one, in their order. Pictures are compared by `seen`, which gets each
// one's first frame and its row; they are not checked against a technique's, and lists of lights are not counted.
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
Expected<BenchRun> run_suites(const std::vector<Suite>& suites, const RunSettings& settings,
                              const std::function<bool()>& stop);

}  // namespace candela
