#include "cli/budget.h"

#include "base/text.h"
#include "bench/error_sweep.h"
#include "report/bench_rows.h"

namespace candela::cli {

void add_budget_options(CLI::App& command, BudgetOptions& o) {
  CLI::Option* time = command.add_option("--time-budget", o.time_ms, "The most exact technique, quality and knobs within this GPU time, by --sweep")
                          ->check(CLI::PositiveNumber)
                          ->type_name("MS");
  command.add_option("--error-budget", o.error, "The cheapest technique, quality and knobs with no more error, by --sweep: relMSE=0.01")
      ->type_name("METRIC=VALUE")
      ->excludes(time);
  command.add_option("--sweep", o.sweep, "File of candela bench --error --json, measured at this size on this device")->type_name("ROWS.json");
  command.add_option("--error-reference", o.reference, "What --error-budget and --time-budget mean by error: exact, direct-unshadowed, direct or path")
      ->capture_default_str()
      ->type_name("NAME");
}

Expected<std::optional<SettingChoice>> choice_within(const CLI::App& command, const BudgetOptions& o, int width_px, int height_px) {
  const bool budgeted = o.time_ms || !o.error.empty();
  if (!budgeted && o.sweep.empty()) return std::nullopt;
  if (!budgeted) return fail(ErrorKind::usage, "--sweep", "goes with --time-budget or --error-budget");
  if (o.sweep.empty()) return fail(ErrorKind::usage, o.time_ms ? "--time-budget" : "--error-budget", "needs --sweep, a file of candela bench --error --json");
  for (const char* option : {"--technique", "--quality", "--samples", "--set"})
    if (command.count(option) > 0) return fail(ErrorKind::usage, option, "is what a budget chooses: give one of the two");
  const std::vector<std::string> references = error_reference_names();
  if (std::find(references.begin(), references.end(), o.reference) == references.end())
    return fail(ErrorKind::usage, "--error-reference", "{}", unknown_name("reference", o.reference, references));
  ErrorBudget budget{.time_ms = o.time_ms, .reference = o.reference};
  if (!o.error.empty())
    if (auto parsed = parse_error_budget(o.error, budget); !parsed) return std::unexpected(parsed.error());
  const auto run = read_bench_rows(o.sweep);
  if (!run) return std::unexpected(run.error());
  auto choice = choose_setting(run->rows, width_px, height_px, budget, o.sweep);
  if (!choice) return std::unexpected(choice.error());
  return std::move(*choice);
}

}  // namespace candela::cli
