#include "report/bench_findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/error_analysis.h"
#include "bench/error_truth.h"
#include "bench/scaling.h"
#include "report/error_rows.h"

namespace candela {
namespace {

int64_t lights_of(const BenchRow& row) { return row.lights_wanted >= 0 ? row.lights_wanted : row.lights; }

std::string ms_of(const BenchRow& row) {
  const Interval ci = median_interval(row.frame.ms);
  return fmt::format("{:.3g} ms ({:.3g} to {:.3g})", median(row.frame.ms), ci.low, ci.high);
}

// "forward-plus takes 1.8 times as long".
std::string beside(const BenchRow& row, const BenchRow& quickest) {
  const bool paired = row.run == quickest.run && paired_order(quickest.frame.ms, row.frame.ms).order == Order::less;
  if (!paired) return row_way(row) + " is not distinguishable from it";
  return fmt::format("{} takes {:.2f} times as long", row_way(row), median(row.frame.ms) / median(quickest.frame.ms));
}

void quickest_sentence(const BenchAxis& axis, const std::string& where, std::vector<PageFinding>& findings) {
  int64_t most = -1;
  for (const BenchRow* row : axis.rows) most = std::max(most, lights_of(*row));
  std::vector<const BenchRow*> rows;
  for (const BenchRow* row : axis.rows)
    if (lights_of(*row) == most) rows.push_back(row);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const BenchRow* a, const BenchRow* b) { return median(a->frame.ms) < median(b->frame.ms); });
  const std::string lights = most < 0 ? "" : fmt::format(", {} light{}", most, most == 1 ? "" : "s");
  if (rows.size() == 1) {
    findings.push_back({fmt::format("{}{}: {} takes {} a frame", where, lights, row_way(*rows[0]), ms_of(*rows[0]))});
    return;
  }
  std::string text =
      fmt::format("{}{}: {} is the quickest with {} a frame", where, lights, row_way(*rows[0]), ms_of(*rows[0]));
  constexpr size_t most_named = 4;
  for (size_t i = 1; i < std::min(rows.size(), most_named); ++i) text += "; " + beside(*rows[i], *rows[0]);
  if (rows.size() > most_named)
    text += fmt::format("; the slowest of all {}, {}, takes {:.2f} times as long", rows.size(), row_way(*rows.back()),
                        median(rows.back()->frame.ms) / median(rows[0]->frame.ms));
  findings.push_back({text});
}

void growth_sentence(const BenchAxis& axis, const std::string& where, std::vector<PageFinding>& findings) {
  std::string text;
  for (const Scaling& s : scalings(axis.rows))
    if (s.top.points >= 3)
      text += fmt::format("{}{} as lights^{:.2f} ({:.0f} to {:.0f})", text.empty() ? "" : ", ", s.way, s.top.exponent,
                          s.top.first_x, s.top.last_x);
  if (!text.empty()) findings.push_back({where + ": the time of a frame grows, " + text});
}

void picture_sentences(const BenchRun& run, std::vector<PageFinding>& findings) {
  size_t compared = 0, wrong = 0, missed = 0;
  uint64_t most = 0;
  std::string worst;
  for (const BenchRow& row : run.rows) {
    if (row.frame.ms.empty()) continue;
    missed += row.lists && row.lists->missed > 0;
    if (row.picture.reference.empty()) continue;
    ++compared;
    wrong += row.picture.differing > 0;
    if (row.picture.differing > most) most = row.picture.differing, worst = row_title(row);
  }
  if (wrong > 0)
    findings.push_back({fmt::format("{} of {} pictures differ from their reference, most in {} pixels: {}", wrong,
                                    compared, most, worst),
                        true});
  else if (compared > 1)
    findings.push_back({fmt::format("all {} pictures are equal to their reference's, bit for bit", compared)});
  if (missed > 0)
    findings.push_back({fmt::format("lists of {} configurations miss lights that shine on a pixel", missed), true});
}

}  // namespace

std::vector<BenchAxis> axes_of(const BenchRun& run) {
  std::vector<BenchAxis> axes;
  for (const BenchRow& row : run.rows) {
    if (row.frame.ms.empty()) continue;
    const std::string name = row_axis(row);
    const auto found = std::find_if(axes.begin(), axes.end(), [&](const BenchAxis& a) { return a.name == name; });
    BenchAxis& axis = found == axes.end() ? axes.emplace_back(BenchAxis{name, {}}) : *found;
    axis.rows.push_back(&row);
  }
  return axes;
}

std::vector<PageFinding> bench_findings(const BenchRun& run) {
  std::vector<PageFinding> findings;
  picture_sentences(run, findings);
  std::stable_partition(findings.begin(), findings.end(), [](const PageFinding& f) { return f.wrong; });
  const std::vector<BenchAxis> axes = axes_of(run);
  constexpr size_t most_places = 6;
  std::vector<std::string> devices;
  for (const BenchAxis& axis : axes) devices.push_back(axis.rows.front()->device);
  const bool several = std::any_of(devices.begin(), devices.end(), [&](const auto& d) { return d != devices[0]; });
  for (size_t i = 0; i < std::min(axes.size(), most_places); ++i) {
    const BenchRow& first = *axes[i].rows.front();
    const std::string where = row_setting(first) + (several ? ", " + first.device : "");
    quickest_sentence(axes[i], where, findings);
    growth_sentence(axes[i], where, findings);
  }
  if (axes.size() > most_places)
    findings.push_back({fmt::format("{} more places are below", axes.size() - most_places)});
  const size_t without = rows_without_runs(run).size();
  if (without > 0)
    findings.push_back({fmt::format("{} configurations have no runs: the list stands below", without), true});
  return findings;
}

std::vector<PageFinding> error_findings(const BenchRun& run) {
  std::vector<PageFinding> findings;
  for (const ErrorPlace& place : error_places(run)) {
    const BenchRow& first = *place.rows.front();
    const std::string where = first.scene + (lights_of(first) < 0 ? "" : fmt::format(", {} lights", lights_of(first)));
    for (const std::string& defect : error_defects(place.rows)) findings.push_back({defect, true});
    constexpr double bounds[] = {0.01, 0.001};
    for (const std::string& sentence : cheapest_sentences(place.rows, bounds))
      findings.push_back({where + ": " + sentence});
  }
  return findings;
}

}  // namespace candela
