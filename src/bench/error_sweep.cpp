#include "bench/error_sweep.h"

#include <algorithm>

#include "base/clock.h"
#include "base/log.h"
#include "bench/error_place.h"
#include "bench/sweep_places.h"

namespace candela {
Expected<BenchRun> run_error_sweep(const ErrorSweepOptions& options, const RunSettings& settings,
                                   const std::function<bool()>& stop,
                                   const std::function<void(const BenchRun&)>& progress) {
  const auto start = Clock::now();
  SceneStore store;
  const double budget_s = options.base.budget_s;
  if (budget_s <= 0) log::info("error against time of everything: planning what there is to measure");
  auto places = budget_s > 0 ? whole_places(options.base) : sweep_places(options.base, store);
  if (!places) return std::unexpected(places.error());
  // What was kept stays, whether this run comes to it or not.
  BenchRun all{.rows = options.kept};
  int run_index = 0;
  for (const BenchRow& kept : options.kept) run_index = std::max(run_index, kept.run + 1);
  for (size_t i = 0; i < places->size(); ++i, ++run_index) {
    const std::string label = (*places)[i].rows.front().configuration.scene.label;
    // What one place leaves of its time the others have.
    const double left_s = std::max(0.001, budget_s - ms_since(start) / 1000);
    const auto with_rows = [&](BenchRun run, const std::vector<BenchRow>& rows) {
      for (const BenchRow& row : rows) run.rows.emplace_back(row).run = run_index;
      run.wall_s = ms_since(start) / 1000;
      return run;
    };
    const auto run =
        run_error_place(std::move((*places)[i]), options, budget_s > 0 ? left_s / double(places->size() - i) : 0, store,
                        settings, stop, [&](const std::vector<BenchRow>& rows) {
                          if (!progress) return;
                          BenchRun so_far = with_rows(all, rows);
                          so_far.notes.emplace_back("the run had not ended when this was written");
                          progress(so_far);
                        });
    if (!run) return run;
    all = with_rows(std::move(all), run->rows);
    for (const std::string& note : run->notes) all.notes.push_back(label + ": " + note);
    all.opening_s += run->opening_s;
    all.stopped = all.stopped || run->stopped;
  }
  return all;
}

}  // namespace candela
