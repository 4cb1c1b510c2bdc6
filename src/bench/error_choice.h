#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/row.h"
#include "render/job.h"

namespace candela {

// What a render may cost or get wrong; one of the two is given.
struct ErrorBudget {
  std::optional<double> time_ms;  // on the GPU: the most exact setting within it
  std::string metric = "relmse";  // by which settings are ordered
  std::optional<double> error;    // the cheapest setting that is no worse
  std::string reference = "direct-unshadowed";
};
// "relMSE=0.01": any metric where less is better; capitals do not matter. Errors: usage.
Expected<void> parse_error_budget(const std::string& text, ErrorBudget& budget);

struct SettingChoice {
  std::string technique, quality;
  std::vector<KnobSetting> settings;
  int samples = 0;
  double ms = 0, error = 0;  // the worst over the sweep's places
  std::string device, text;  // text: for readers
};
// Of the rows of a sweep at the size given. A setting counts by its worst place, and only where every place has it. Errors: no rows of
// the size or the reference (input), no setting within the budget (usage), with what the best would need.
Expected<SettingChoice> choose_setting(const std::vector<BenchRow>& rows, int width_px, int height_px, const ErrorBudget& budget,
                                       const std::string& file);

}  // namespace candela
