#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "bench/error_choice.h"

namespace candela::cli {

// --time-budget and --error-budget: technique, quality and knobs come from the file of a sweep.
struct BudgetOptions {
  std::optional<double> time_ms;
  std::string error, sweep, reference;  // reference: empty: that which the rows are judged by
};
void add_budget_options(CLI::App& command, BudgetOptions& options);

// nullopt where no budget is given. job: what is to be rendered but for what a budget chooses; device: as
// DeviceOptions::which. Errors: options that say the same otherwise, a scene or device that cannot be found, and those
// of choose_setting().
Expected<std::optional<SettingChoice>> choice_within(const CLI::App& command, const BudgetOptions& options,
                                                     const Job& job, const std::string& device);

}  // namespace candela::cli
