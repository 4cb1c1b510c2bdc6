#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "bench/row.h"
#include "job/job.h"

namespace candela {

// What a render may cost or get wrong; one of the two is given.
struct ErrorBudget {
  // On the GPU: the most exact setting within it. A setting is within when the upper end of the 95 % confidence
  // interval of its median is.
  std::optional<double> time_ms;
  std::string metric = "relmse";  // by which settings are ordered
  // The cheapest setting that is no worse: when the upper end of its error's interval is.
  std::optional<double> error;
  std::string reference = "direct-unshadowed";
};
// "relMSE=0.01": any metric where less is better; capitals do not matter. Errors: usage.
Expected<void> parse_error_budget(const std::string& text, ErrorBudget& budget);

// What is to be rendered: only rows of the same scene, size and device say anything about it.
struct BudgetPlace {
  std::string scene, scene_content;  // scene: for messages
  int width_px = 0, height_px = 0;
  std::string device;
};

struct SettingChoice {
  std::string technique, quality;
  std::vector<KnobSetting> settings;
  int samples = 0;
  double ms = 0, error = 0;  // the worst over the sweep's cameras and times
  Interval ms_ci, error_ci;  // the same
  std::string text;          // for readers
};
// Of the rows of a sweep at the place given. Where it has several cameras or times a setting counts by its worst, and
// only where all have it. Errors: no rows of the reference, scene, size or device (input), no setting within the budget
// (usage), with what the best would need.
Expected<SettingChoice> choose_setting(const std::vector<BenchRow>& rows, const BudgetPlace& place,
                                       const ErrorBudget& budget, const std::string& file);

}  // namespace candela
