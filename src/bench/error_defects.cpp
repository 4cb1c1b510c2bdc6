#include "base/text.h"
#include "bench/error_analysis.h"
#include "bench/error_truth.h"

// error_defects() of error_analysis.h.
namespace candela {
namespace {

// Settings without one of them.
std::string without_setting(const std::string& settings, const std::string& one) {
  std::vector<std::string> kept = split(settings, ' ');
  std::erase(kept, one);
  return joined(kept, " ");
}

// The row of the same technique and quality with these settings, under whichever name it was measured.
const BenchRow* row_with(std::span<const BenchRow* const> rows, const BenchRow& like, const std::string& settings) {
  for (const BenchRow* row : rows) {
    if (row->technique == like.technique && row->quality == like.quality && row->settings == settings) return row;
    for (const SameWork& same : row->same_work)
      if (same.technique == like.technique && same.quality == like.quality && same.settings == settings) return row;
  }
  return nullptr;
}

// A knob of time that does nothing without other settings leaves the picture that these make alone: equal in every
// metric to the last bit, where no reference is that picture itself.
bool changes_nothing(std::span<const BenchRow* const> rows, const BenchRow& row, const std::string& setting) {
  const std::string beside = without_setting(row.settings, setting);
  const BenchRow* alone = beside.empty() ? nullptr : row_with(rows, row, beside);
  const PictureError* with = error_against(row, exact_reference);
  const PictureError* without = alone ? error_against(*alone, exact_reference) : nullptr;
  return with && without && with->metrics == without->metrics;
}

}  // namespace

std::vector<std::string> error_defects(std::span<const BenchRow* const> rows) {
  std::vector<std::string> defects;
  for (const BenchRow* row : rows) {
    if (row->suite == "whole" || row->knobs.empty() || row->knobs.front().kind != "time") continue;
    const std::string setting = row->knobs.front().knob + "=" + row->knobs.front().value;
    if (const auto differing = error_of(*row, exact_reference, "differing");
        differing && *differing > 0 && !changes_nothing(rows, *row, setting))
      defects.push_back(fmt::format("{}, {}: {} must change nothing but time, and {:.0f} pixels differ",
                                    error_place(*row), row->technique, setting, *differing));
  }
  return defects;
}

}  // namespace candela
