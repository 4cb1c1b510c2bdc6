#include "cli/budget.h"

#include "base/text.h"
#include "bench/error_analysis.h"
#include "bench/error_truth.h"
#include "cli/job_options.h"
#include "gpu/device_select.h"
#include "job/content_hash.h"
#include "job/job_look.h"
#include "plan/posed_scene.h"
#include "report/bench_rows.h"
#include "sky/job_sky.h"

namespace candela::cli {
namespace {

Expected<BudgetPlace> place_of(const Job& job, const std::string& device) {
  BudgetPlace place{.scene = job.scene, .width_px = job.width_px, .height_px = job.height_px};
  const auto scene = load_scene(job);
  if (!scene) return std::unexpected(scene.error());
  const auto look = look_of(job);
  if (!look) return std::unexpected(look.error());
  const auto skies = sky_files(job, *look);
  if (!skies) return std::unexpected(skies.error());
  const auto content = hash_files(scene->files, *skies, job.look);
  if (!content) return std::unexpected(content.error());
  place.scene_content = content->hex();
  const auto devices = gpu::list_devices();
  if (!devices) return std::unexpected(devices.error());
  const auto index = gpu::choose_device(*devices, device);
  if (!index) return std::unexpected(index.error());
  place.device = (*devices)[size_t(*index)].name;
  return place;
}

}  // namespace

void add_budget_options(CLI::App& command, BudgetOptions& o) {
  CLI::Option* time = command
                          .add_option("--time-budget", o.time_ms,
                                      "Use the most exact technique, quality and knobs of --sweep whose GPU time is "
                                      "below this with 95 % confidence")
                          ->check(positive_number())
                          ->type_name("MS");
  command
      .add_option("--error-budget", o.error,
                  "Use the cheapest technique, quality and knobs of --sweep with at most this error: relMSE=0.01")
      ->type_name("METRIC=VALUE")
      ->excludes(time);
  command
      .add_option("--sweep", o.sweep, "File of candela bench --error --json, of this scene at this size on this device")
      ->type_name("ROWS.json");
  command
      .add_option("--error-reference", o.reference,
                  "What error is measured against for --error-budget and --time-budget: exact, direct-unshadowed, "
                  "direct or path; by default the reference that the file's rows are judged by")
      ->type_name("NAME");
}

Expected<std::optional<SettingChoice>> choice_within(const CLI::App& command, const BudgetOptions& o, const Job& job,
                                                     const std::string& device) {
  const bool budgeted = o.time_ms || !o.error.empty();
  if (!budgeted && o.sweep.empty()) return std::nullopt;
  if (!budgeted) return fail(ErrorKind::usage, "--sweep", "goes with --time-budget or --error-budget");
  if (o.sweep.empty())
    return fail(ErrorKind::usage, o.time_ms ? "--time-budget" : "--error-budget",
                "needs --sweep, a file of candela bench --error --json");
  for (const char* option : {"--technique", "--quality", "--samples", "--set"})
    if (command.count(option) > 0)
      return fail(ErrorKind::usage, option, "is what a budget chooses: give one of the two");
  const std::vector<std::string> references = error_reference_names();
  if (!o.reference.empty() && std::find(references.begin(), references.end(), o.reference) == references.end())
    return fail(ErrorKind::usage, "--error-reference", "{}", unknown_name("reference", o.reference, references));
  ErrorBudget budget{.time_ms = o.time_ms, .reference = o.reference};
  if (!o.error.empty())
    if (auto parsed = parse_error_budget(o.error, budget); !parsed) return std::unexpected(parsed.error());
  const auto run = read_bench_rows(o.sweep);
  if (!run) return std::unexpected(run.error());
  if (budget.reference.empty()) {
    std::vector<const BenchRow*> rows;
    for (const BenchRow& row : run->rows) rows.push_back(&row);
    budget.reference = truth_of(rows);
  }
  const auto place = place_of(job, device);
  if (!place) return std::unexpected(place.error());
  auto choice = choose_setting(run->rows, *place, budget, o.sweep);
  if (!choice) return std::unexpected(choice.error());
  return std::move(*choice);
}

}  // namespace candela::cli
