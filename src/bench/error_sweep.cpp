#include "bench/error_sweep.h"

#include <algorithm>

#include "base/clock.h"
#include "bench/error_place.h"
#include "bench/error_walk.h"

namespace candela {
Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop,
                                   const std::function<void(const BenchRun&)>& progress) {
  const auto start = Clock::now();
  SceneStore store;
  const double budget_s = options.base.budget_s;
  auto places = budget_s > 0 ? whole_places(options.base) : sweep_places(options.base, store);
  if (!places) return std::unexpected(places.error());
  BenchRun all;
  int run_index = 0;
  for (const BenchRow& kept : options.kept) run_index = std::max(run_index, kept.run + 1);
  for (size_t i = 0; i < places->size(); ++i) {
    const std::string label = (*places)[i].rows.front().configuration.scene.label;
    // What one place leaves of its time the others have.
    const double share_s =
        budget_s > 0 ? std::max(0.001, (budget_s - ms_since(start) / 1000) / double(places->size() - i)) : 0;
    const auto with_run = [&](BenchRow row) {
      const bool kept = std::ranges::any_of(options.kept, [&](const BenchRow& k) {
        return k.job == row.job && k.suite == row.suite && k.gpu.ms == row.gpu.ms;
      });
      if (!kept) row.run = run_index;
      return row;
    };
    auto run = run_error_place(std::move((*places)[i]), options, share_s, store, settings, stop,
                               [&](const std::vector<BenchRow>& rows) {
                                 if (!progress) return;
                                 BenchRun so_far = all;
                                 for (const BenchRow& row : rows) so_far.rows.push_back(with_run(row));
                                 so_far.notes.emplace_back("the run had not ended when this was written");
                                 so_far.wall_s = ms_since(start) / 1000;
                                 progress(so_far);
                               });
    if (!run) return run;
    for (BenchRow& row : run->rows) all.rows.push_back(with_run(std::move(row)));
    ++run_index;
    for (const std::string& note : run->notes) all.notes.push_back(label + ": " + note);
    all.opening_s += run->opening_s;
    all.stopped = all.stopped || run->stopped;
  }
  all.wall_s = ms_since(start) / 1000;
  return all;
}

}  // namespace candela
