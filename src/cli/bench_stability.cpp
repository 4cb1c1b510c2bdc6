#include "cli/bench_stability.h"

#include <nlohmann/json.hpp>

#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/report_files.h"
#include "cli/result.h"
#include "cli/signals.h"
#include "job/frame_choices.h"
#include "render/frame_names.h"
#include "report/stability_report.h"
#include "stability/stability.h"
#include "techniques/technique.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json row_json(const StabilityRow& row) {
  return {{"family", row.family},
          {"scene", row.scene},
          {"what", row.what},
          {"technique", row.technique},
          {"truth", row.truth},
          {"pass", row.faults.empty()},
          {"faults", row.faults},
          {"refused", row.error},
          {"pixels", row.pixels},
          {"nonfinite", row.nonfinite},
          {"nonfinite_with_effects", row.effects_nonfinite},
          {"max_relative_error", number_or_null(row.max_relative)},
          {"bound", row.bound},
          {"max_relative_error_against_plain", number_or_null(row.plain_relative)},
          {"plain_bound", row.plain_bound},
          {"beyond_bound", row.beyond},
          {"may_be_beyond", row.may_be_beyond},
          {"worst", row.worst},
          {"energy", number_or_null(row.energy)},
          {"energy_bound", row.energy_bound},
          {"display_error", number_or_null(row.display_error)},
          {"clamped", row.clamped},
          {"differing", row.differing},
          {"warnings", row.warnings},
          {"wall_ms", row.wall_ms}};
}

Json report_json(const StabilityReport& report) {
  Json rows = Json::array();
  for (const StabilityRow& row : report.rows) rows.push_back(row_json(row));
  return {{"version", CANDELA_VERSION},
          {"device", report.device},
          {"driver", report.driver},
          {"seed", report.seed},
          {"large", report.large},
          {"scenes", report.scenes},
          {"faulty_rows", report.faulty_rows},
          {"nonfinite", report.nonfinite},
          {"display_bound", display_bound},
          {"left_out", {"automatic exposure"}},  // of display output
          {"stopped", report.stopped},
          {"wall_s", report.wall_s},
          {"rows", std::move(rows)}};
}

bool same_picture(const StabilityRow& a, const StabilityRow& b) {
  return a.family == b.family && a.scene == b.scene && b.differing == 0 && a.faults == b.faults;
}

std::string rows_text(const StabilityReport& report) {
  std::vector<std::vector<std::string>> table = {{"SCENE", "TECHNIQUE", "NOT FINITE", "ERROR", "BOUND", "BEYOND",
                                                  "PLAIN", "ENERGY", "CLAMPED", "WARNS", "RESULT"}};
  std::string faults;
  for (size_t i = 0; i < report.rows.size();) {
    const StabilityRow& row = report.rows[i];
    size_t end = i + 1;  // techniques of the same bits are one line
    while (end < report.rows.size() && same_picture(row, report.rows[end])) ++end;
    const bool has_plain = row.truth.find("plain") != std::string::npos,
               traced = row.truth.find("reference") != std::string::npos ||
                        row.truth.find("closed form") != std::string::npos;
    const bool drawn = row.error.empty();
    table.push_back({row.family + ": " + row.scene, end - i > 1 ? fmt::format("{} alike", end - i) : row.technique,
                     drawn ? fmt::format("{}", row.nonfinite) : "",
                     traced ? fmt::format("{:.2g}", row.max_relative) : "",
                     traced ? fmt::format("{:g}", row.bound) : "",
                     drawn && row.beyond > 0 ? fmt::format("{} of {}", row.beyond, row.may_be_beyond) : "",
                     has_plain ? fmt::format("{:.2g}", row.plain_relative) : "",
                     traced || has_plain ? fmt::format("{:+.1e}", row.energy) : "",
                     drawn ? fmt::format("{}", row.clamped) : "", drawn ? fmt::format("{}", row.warnings.size()) : "",
                     !row.faults.empty() ? "WRONG"
                     : drawn             ? "right"
                                         : "refused"});
    for (const std::string& fault : row.faults)
      faults += fmt::format("{}: {}, {}: {}\n", row.family, row.scene, end - i > 1 ? "all" : row.technique, fault);
    i = end;
  }
  return table_text(table) + faults +
         fmt::format("{} scenes, {} pictures in {:.1f} s on {}: {} pixels not finite, {} rows wrong\n", report.scenes,
                     report.rows.size(), report.wall_s, report.device, report.nonfinite, report.faulty_rows);
}

}  // namespace

Expected<int> run_stability(const BenchOptions& o) {
  StabilityOptions options;
  if (!o.stability_file.empty()) {
    auto read = read_stability_suite(o.stability_file);
    if (!read) return std::unexpected(read.error());
    options = std::move(*read);
  }
  if (o.seed) options.seed = *o.seed;
  if (o.large) options.large = true;
  if (!o.only.empty()) options.only = split(o.only, ',');
  options.pictures = o.pictures;
  options.thumbnails = !o.report.empty();
  if (!o.techniques.empty()) options.techniques = split(o.techniques, ',');
  for (std::string& name : options.techniques) {
    const auto named = technique_named(name, o.device);
    if (!named) return std::unexpected(named.error());
    name = *named;
    if (const auto names = technique_names(); std::find(names.begin(), names.end(), name) == names.end())
      return fail(ErrorKind::usage, "--techniques", "{}", unknown_name("technique", name, names));
  }
  for (const std::string& text : o.settings) {
    const auto setting = parse_knob_setting(text);
    if (!setting) return std::unexpected(Error{ErrorKind::usage, setting.error().message, "--set"});
    options.settings.push_back(*setting);
  }
  if (!o.json.empty() && o.json != "-")
    if (auto ready = prepare_output(o.json); !ready) return std::unexpected(ready.error());
  if (auto ready = prepare_report(o.report); !ready) return std::unexpected(ready.error());
  const HeldSignals signals;
  const auto report = check_stability(options, bench_settings(o), [&] { return signals.pending() != 0; });
  if (!report) return std::unexpected(report.error());
  if (report->stopped) log::warning("stopped before the end");
  const std::string json = report_json(*report).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  if (!o.json.empty())
    if (auto written = write_text_output(o.json, json); !written) return std::unexpected(written.error());
  const auto page = [&](Figures& figures) { return stability_html(*report, this_program(), figures); };
  if (auto written = write_report(o.report, {{"stability.json", json}}, page); !written)
    return std::unexpected(written.error());
  if (o.json != "-")
    if (auto printed = print(rows_text(*report)); !printed) return std::unexpected(printed.error());
  if (report->scenes == 0) return fail(ErrorKind::usage, "--only", "no scene has that in its name");
  return report->faulty_rows > 0 ? int(ErrorKind::comparison) : 0;
}

}  // namespace candela::cli
