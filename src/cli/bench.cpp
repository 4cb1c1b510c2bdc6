#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/log.h"
#include "base/text.h"
#include "bench/error_analysis.h"
#include "bench/run_suite.h"
#include "bench/stillness.h"
#include "cli/bench_options.h"
#include "cli/bench_stability.h"
#include "cli/build_info.h"
#include "cli/command.h"
#include "cli/report_files.h"
#include "cli/result.h"
#include "cli/signals.h"
#include "gltf/gltf.h"
#include "render/frame_names.h"
#include "report/bench_report.h"
#include "report/bench_rows.h"
#include "report/error_rows.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Table = std::vector<std::vector<std::string>>;
using Json = nlohmann::ordered_json;

std::string milliseconds(const Series& s) {
  const Summary sum = summary(s.ms);
  return sum.count == 0 ? "" : fmt::format("{:.3f} ± {:.3f}", sum.median, sum.mad);
}

std::string differing(const BenchRow& row) {
  return row.picture.reference.empty() ? "" : fmt::format("{}", row.picture.differing);
}

std::string rows_text(const BenchRun& run) {
  // Of frames alone: their passes, timed one by one, are another quantity (--json, --report).
  Table table = {{"CONFIGURATION", "FRAME MS", "MIN", "RUNS", "DIFFERING", "NOTE"}};
  std::map<std::string, int> without;  // by the reason
  for (const BenchRow& row : run.rows) {
    const std::string note = !row.error.empty()      ? row.error
                             : !row.left_out.empty() ? "left out: " + row.left_out
                             : row.budget_hit        ? "time ran out"
                             : row.runs_capped       ? "cap on runs"
                                                     : "";
    if (row.frame.ms.empty() && ++without[note] > 1) continue;
    table.push_back({row_title(row), milliseconds(row.frame),
                     row.frame.ms.empty() ? "" : fmt::format("{:.3f}", summary(row.frame.ms).min),
                     fmt::format("{}", row.frame.ms.size()), differing(row), note});
  }
  std::string text = table_text(table);
  for (const auto& [note, count] : without)
    if (count > 1) text += fmt::format("and {} more without runs: {}\n", count - 1, note);
  return text;
}

Expected<void> write_files(const BenchOptions& o, const BenchRun& run, const std::string& title) {
  const std::string json = bench_json(run).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  const std::string csv = bench_csv(run);
  std::vector<std::pair<std::string, const std::string*>> files;
  if (!o.json.empty()) files.emplace_back(o.json, &json);
  if (!o.csv.empty()) files.emplace_back(o.csv, &csv);
  for (const auto& [file, text] : files)
    if (auto written = write_text_output(file, *text); !written) return written;
  return write_report(o.report, {{"rows.json", json}, {"rows.csv", csv}},
                      [&](Figures& figures) { return bench_html(run, title, figures); });
}

// Before the first sample: an hour of measuring must not end at a folder that cannot be written.
Expected<void> prepare_files(const BenchOptions& o) {
  if (o.json == "-" && o.csv == "-") return fail(ErrorKind::usage, "--csv", "- and --json - both ask for stdout");
  for (const std::string& file : {o.json, o.csv})
    if (!file.empty() && file != "-")
      if (auto ready = prepare_output(file); !ready) return ready;
  if (auto ready = prepare_report(o.report); !ready) return ready;
  return check_outputs();
}

// What the scenes of a suite name, before an hour is spent on them.
void note_files_of(const Suite& suite) {
  for (const SuiteScene& scene : suite.scenes)
    if (!scene.file.empty()) note_scene_files(scene.file);
}

// 0 when every row that a suite does not leave out was measured.
int code_of(const BenchRun& run) {
  const std::vector<std::string> without = rows_without_runs(run);
  for (const std::string& title : without) log::error("no runs: {}", title);
  for (const BenchRow& row : run.rows)
    if (row.error_kind != 0) return row.error_kind;
  if (!without.empty()) return int(ErrorKind::device);
  const bool any = std::any_of(run.rows.begin(), run.rows.end(), [](const auto& row) { return !row.frame.ms.empty(); });
  if (!any) log::error("nothing was measured: every configuration is left out");
  return any ? 0 : int(ErrorKind::input);
}

Expected<int> finish(const BenchOptions& o, const BenchRun& run, const std::string& title) {
  if (auto written = write_files(o, run, title); !written) return std::unexpected(written.error());
  if (o.json != "-" && o.csv != "-")
    if (auto printed = print(rows_text(run)); !printed) return std::unexpected(printed.error());
  return code_of(run);
}

// One line a technique and kind of answer.
std::string study_sentences(const std::vector<KnobStudy>& studies) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> told;
  for (const KnobStudy& study : studies) {
    if (study.values.empty()) continue;
    const bool idle = study.values.front().verdict == "changes nothing in this picture";
    const char* what = !study.advised.empty() ? "worth their time"
                       : idle                 ? "change nothing in this picture"
                                              : "no value is surely worth its time";
    told[{study.technique, what}].push_back(study.advised.empty() ? study.knob : study.knob + "=" + study.advised);
  }
  std::string text;
  for (const auto& [key, knobs] : told) text += fmt::format("  {}: {}: {}\n", key.first, key.second, joined(knobs));
  return text;
}

std::string error_sentences(const BenchRun& run) {
  std::string text;
  for (const ErrorPlace& place : error_places(run)) {
    text += "\n" + place.name + "\n";
    for (const std::string& sentence : cheapest_sentences(place.rows, error_bounds)) text += "  " + sentence + "\n";
    const std::vector<BenchRow> named = rows_by_name(place.rows);
    std::vector<const BenchRow*> by_name;
    for (const BenchRow& row : named) by_name.push_back(&row);
    text += study_sentences(knob_studies(by_name));
    for (const NoiseVerdict& verdict : noise_verdicts(place.rows)) text += "  " + verdict.sentence + "\n";
  }
  return text;
}

// Rows are written as they come, so that whatever ends the run leaves them: to the file of --json, else to that of the
// report.
fs::path rows_file(const BenchOptions& o) {
  if (!o.json.empty() && o.json != "-") return o.json;
  return o.report.empty() ? fs::path() : fs::path(o.report) / "rows.json";
}

// Rows that were kept name the program that measured them.
BenchRun with_source(BenchRun run) {
  for (BenchRow& row : run.rows)
    if (row.source.empty()) row.source = source_version;
  return run;
}

Expected<int> run_errors(const BenchOptions& o) {
  auto sweep = error_sweep_of(o);
  if (!sweep) return std::unexpected(sweep.error());
  note_files_of(sweep->base);
  if (auto ready = prepare_files(o); !ready) return std::unexpected(ready.error());
  std::error_code failed;
  if (o.resume && fs::exists(o.json, failed)) {
    // What it holds is gone on from, so that writing it again loses nothing.
    if (const int file = ::open(o.json.c_str(), O_RDONLY | O_CLOEXEC); file >= 0) note_written(file), ::close(file);
    auto kept = read_bench_rows(o.json);
    if (!kept) return std::unexpected(kept.error());
    sweep->kept = std::move(kept->rows);
  }
  const fs::path rows = rows_file(o);
  const HeldSignals signals;
  auto run = run_error_sweep(
      *sweep, bench_settings(o), [&] { return signals.pending() != 0; },
      [&](const BenchRun& so_far) {
        if (rows.empty()) return;
        const std::string text =
            bench_json(with_source(so_far)).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
        if (auto written = write_file_atomically(rows, std::string_view(text)); !written)
          log::warning("the rows measured so far could not be saved: {}", written.error().text());
      });
  if (!run) return std::unexpected(run.error());
  if (run->rows.empty() && !run->stopped)
    return fail(ErrorKind::usage, "--budget-s", "nothing was measured: {}", joined(run->notes, "; "));
  *run = with_source(std::move(*run));
  const auto finished = finish(o, *run, "candela bench: error against time");
  if (finished && o.json != "-" && o.csv != "-")
    if (auto printed = print(error_sentences(*run)); !printed) return std::unexpected(printed.error());
  if (signals.pending() && finished && !rows.empty())
    log::info("{} holds what was measured; --resume goes on from there", rows.string());
  if (signals.pending() && finished) return 128 + signals.pending();
  if (!finished || *finished != 0) return finished;
  int defects = 0;
  for (const ErrorPlace& place : error_places(*run))
    for (const std::string& defect : error_defects(place.rows)) {
      log::error("{}", defect);
      ++defects;
    }
  return defects > 0 ? int(ErrorKind::comparison) : 0;
}

Expected<int> run_measure(const BenchOptions& o) {
  const auto suites = suites_of(o);
  if (!suites) return std::unexpected(suites.error());
  for (const Suite& suite : *suites) note_files_of(suite);
  if (auto ready = prepare_files(o); !ready) return std::unexpected(ready.error());
  const HeldSignals signals;
  auto run = run_suites(*suites, bench_settings(o), [&] { return signals.pending() != 0; });
  if (!run) return std::unexpected(run.error());
  for (BenchRow& row : run->rows) row.source = source_version;
  std::vector<std::string> names;
  for (const Suite& suite : *suites)
    if (!suite.name.empty()) names.push_back(suite.name);
  return finish(o, *run, "candela bench" + (names.empty() ? "" : ": " + joined(names)));
}

// ": error against time", or the suites of the rows.
std::string title_of(const BenchRun& run) {
  std::vector<std::string> names;
  for (const BenchRow& row : run.rows) {
    if (!row.errors.empty()) return ": error against time";
    if (!row.suite.empty() && std::find(names.begin(), names.end(), row.suite) == names.end())
      names.push_back(row.suite);
  }
  return names.empty() ? "" : ": " + joined(names);
}

// A report from rows that were kept, also of several runs and devices.
Expected<int> run_from_rows(const BenchOptions& o) {
  if (auto ready = prepare_files(o); !ready) return std::unexpected(ready.error());
  BenchRun all;
  int runs = 0;
  for (const std::string& file : o.from) {
    auto run = read_bench_rows(file);
    if (!run) return std::unexpected(run.error());
    // Rounds of one run are none of another's.
    int last = -1;
    for (BenchRow& row : run->rows) {
      last = std::max(last, row.run);
      row.run += runs;
      all.rows.push_back(std::move(row));
    }
    runs += last + 1;
    for (const std::string& note : run->notes) all.notes.push_back(fs::path(file).filename().string() + ": " + note);
    all.wall_s += run->wall_s, all.opening_s += run->opening_s;
  }
  if (auto written = finish(o, all, "candela bench" + title_of(all)); !written) return written;
  return 0;
}

// A file of rows; or of a folder of them the one that was measured on the same device.
Expected<BenchRun> read_baseline(const std::string& name, const BenchRun& now) {
  std::error_code failed;
  if (!fs::is_directory(name, failed)) return read_bench_rows(name);
  const auto place = [](const BenchRun& run) {
    return run.rows.empty() ? std::string() : row_device(run.rows.front());
  };
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(name, failed))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<std::string> there;
  for (const fs::path& file : files) {
    auto run = read_bench_rows(file);
    if (!run) return run;
    if (place(*run) == place(now)) return run;
    there.push_back(place(*run));
  }
  return fail(ErrorKind::input, name, "holds no rows of {}{}", place(now),
              there.empty() ? "" : ", only of " + joined(there, "; "));
}

// The contract of --no-slower-than: 0 where it is sure of every row.
int gate_code(const RowComparison& result, double percent, std::string& text) {
  const double most = 1 + percent / 100;
  int slower = 0, unclear = 0;
  Table table = {{"CONFIGURATION", "RATIO", "95 % CI", "GATE"}};
  for (const auto& [title, middle, ratio] : result.frames) {
    const bool fine = ratio.high <= most, sure = ratio.low > most;
    slower += sure, unclear += !fine && !sure;
    table.push_back({title, fmt::format("{:.3f}", middle), fmt::format("{:.3f} to {:.3f}", ratio.low, ratio.high),
                     fine   ? "passes"
                     : sure ? "slower"
                            : "cannot tell"});
  }
  text += table_text(table);
  const size_t rows = result.frames.size(), missing = result.only_old.size() + result.not_comparable.size();
  if (missing > 0)
    text += fmt::format("{} rows cannot be compared (above): of them nothing is shown\n", missing);
  else if (rows == 0)
    text += "no row is in both files: nothing is shown\n";
  else if (slower + unclear == 0)
    text += fmt::format("no frame is slower by more than {:g} %, with 95 % confidence in all {} rows\n", percent, rows);
  else
    text += fmt::format(
        "{} of {} rows are slower by more than {:g} %, of {} it cannot be told: measure those longer "
        "(--min-runs, --precision)\n",
        slower, rows, percent, unclear);
  return rows > 0 && missing + slower + unclear == 0 ? 0 : int(ErrorKind::comparison);
}

Expected<int> run_compare(const BenchOptions& o) {
  const auto after = read_bench_rows(o.compare[1]);
  if (!after) return std::unexpected(after.error());
  const auto before = read_baseline(o.compare[0], *after);
  if (!before) return std::unexpected(before.error());
  const auto result = compare_rows(before->rows, after->rows, {.min_relative = o.min_change});
  if (!result) return std::unexpected(result.error());
  static constexpr const char* verdicts[] = {"same", "slower", "faster", "too few runs"};
  Table table = {{"CONFIGURATION", "WHAT", "OLD MS", "NEW MS", "RATIO", "NOISE MS", "VERDICT"}};
  int counts[4] = {};
  for (const RowChange& c : result->changes) {
    const Judgement& j = c.judgement;
    ++counts[int(j.verdict)];
    if (j.verdict == Verdict::same) continue;
    table.push_back({c.title, c.quantity, fmt::format("{:.3f}", j.old_median), fmt::format("{:.3f}", j.new_median),
                     fmt::format("{:.3f}", j.ratio()), fmt::format("{:.3f}", j.bound), verdicts[int(j.verdict)]});
  }
  std::string text = table.size() > 1 ? table_text(table) : std::string();
  const auto list = [&](const char* what, const std::vector<std::string>& titles) {
    for (const std::string& title : titles) text += fmt::format("{}: {}\n", what, title);
  };
  list("picture worse", result->worse_pictures);
  list("only in the old file", result->only_old);
  list("only in the new file", result->only_new);
  list("not comparable", result->not_comparable);
  text += fmt::format("{} slower, {} faster, {} within noise, {} with too few runs\n", counts[1], counts[2], counts[0],
                      counts[3]);
  const int gate = o.no_slower_percent ? gate_code(*result, *o.no_slower_percent, text) : 0;
  if (!o.json.empty())
    if (auto written = write_text_output(o.json, comparison_json(*result).dump(2) + "\n"); !written)
      return std::unexpected(written.error());
  if (o.json != "-")
    if (auto printed = print(text); !printed) return std::unexpected(printed.error());
  if (!result->worse_pictures.empty()) return int(ErrorKind::comparison);
  return o.no_slower_percent ? gate : result->slower() ? int(ErrorKind::comparison) : 0;
}

std::string rows_text(const ExactnessReport& report) {
  Table table = {{"SCENE", "TECHNIQUE", "PICTURES", "DIFFERING", "PIXELS", "LARGEST"}};
  std::string worst;
  // Scenes that show nothing wrong are one line a technique; --json has them all.
  std::vector<std::pair<ExactnessRow, int>> rows;
  for (const ExactnessRow& row : report.rows) {
    const bool alone = row.scene == report.rows.front().scene || row.differing_pixels > 0;
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& r) {
      return !alone && r.second > 0 && r.first.technique == row.technique;
    });
    if (found == rows.end()) {
      rows.emplace_back(row, alone ? 0 : 1);
    } else {
      found->first.pictures += row.pictures;
      ++found->second;
    }
    if (!row.worst.empty()) worst += fmt::format("{}, worst: {}\n", row.technique, row.worst);
  }
  for (const auto& [row, scenes] : rows)
    table.push_back({scenes > 0 ? fmt::format("{} other scenes", scenes) : row.scene, row.technique,
                     fmt::format("{}", row.pictures), fmt::format("{}", row.differing_pictures),
                     fmt::format("{}", row.differing_pixels), fmt::format("{:.3g}", row.max_difference)});
  return table_text(table) + worst +
         fmt::format("{} pictures in {:.1f} s on {}: {} pixels differ\n", report.pictures, report.wall_s, report.device,
                     report.differing_pixels);
}

nlohmann::ordered_json report_json(const ExactnessReport& report) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ExactnessRow& row : report.rows)
    rows.push_back(
        {{"scene", row.scene},
         {"technique", row.technique},
         {"pictures", row.pictures},
         {"differing_pictures", row.differing_pictures},
         {"differing_pixels", row.differing_pixels},
         {"max_difference", std::isfinite(row.max_difference) ? nlohmann::ordered_json(row.max_difference) : nullptr},
         {"worst", row.worst}});
  return {{"version", CANDELA_VERSION},
          {"device", report.device},
          {"driver", report.driver},
          {"pictures", report.pictures},
          {"differing_pixels", report.differing_pixels},
          {"skipped", report.skipped},
          {"stopped", report.stopped},
          {"wall_s", report.wall_s},
          {"rows", std::move(rows)}};
}

std::string rows_text(const StillnessReport& report) {
  Table table = {{"SCENE", "PLACE", "QUALITY", "LAYER", "SECOND", "TRUTH", "NOISE", "RATIO", "ERROR"}};
  for (const StillnessRow& row : report.rows)
    table.push_back({row.scene, row.what, row.quality, row.layer, fmt::format("{:.5f}", row.second),
                     fmt::format("{:.5f}", row.truth_second), fmt::format("{:.5f}", row.truth_noise),
                     fmt::format("{:.2f}", row.ratio()), fmt::format("{:.5f}", row.error)});
  return table_text(table);
}

Json report_json(const StillnessReport& report, const StillnessOptions& options) {
  Json rows = Json::array();
  for (const StillnessRow& row : report.rows)
    rows.push_back({{"scene", row.scene},
                    {"place", row.what},
                    {"quality", row.quality},
                    {"layer", row.layer},
                    {"pixels", row.pixels},
                    {"second_difference", row.second},
                    {"truth_second_difference", row.truth_second},
                    {"truth_noise", row.truth_noise},
                    {"ratio", row.ratio()},
                    {"error", row.error}});
  return {{"version", CANDELA_VERSION},
          {"device", report.device},
          {"driver", report.driver},
          {"technique", options.technique},
          {"size", {options.width_px, options.height_px}},
          {"frames", options.frames},
          {"step_px", options.step_px},
          {"reference_spp", options.spp},
          {"stopped", report.stopped},
          {"wall_s", report.wall_s},
          {"rows", std::move(rows)}};
}

Expected<int> run_stillness(const BenchOptions& o) {
  const auto options = stillness_of(o);
  if (!options) return std::unexpected(options.error());
  if (auto ready = prepare_files(o); !ready) return std::unexpected(ready.error());
  const HeldSignals signals;
  const auto report = measure_stillness(*options, bench_settings(o), [&] { return signals.pending() != 0; });
  if (!report) return std::unexpected(report.error());
  if (report->stopped) log::warning("stopped before the end");
  if (!o.json.empty())
    if (auto written = write_text_output(o.json, report_json(*report, *options).dump(2) + "\n"); !written)
      return std::unexpected(written.error());
  if (o.json != "-")
    if (auto printed = print(rows_text(*report)); !printed) return std::unexpected(printed.error());
  return 0;
}

Expected<int> run_exactness(const BenchOptions& o) {
  const auto options = exactness_of(o);
  if (!options) return std::unexpected(options.error());
  if (auto ready = prepare_files(o); !ready) return std::unexpected(ready.error());
  const HeldSignals signals;
  const auto report = check_exactness(*options, bench_settings(o), [&] { return signals.pending() != 0; });
  if (!report) return std::unexpected(report.error());
  for (const std::string& skipped : report->skipped) log::warning("skipped {}", skipped);
  if (report->stopped) log::warning("stopped before the end");
  if (!o.json.empty())
    if (auto written = write_text_output(o.json, report_json(*report).dump(2) + "\n"); !written)
      return std::unexpected(written.error());
  if (o.json != "-")
    if (auto printed = print(rows_text(*report)); !printed) return std::unexpected(printed.error());
  if (report->pictures == 0)
    return fail(ErrorKind::usage, "--count",
                "no picture was compared: the run stopped before the first, or --count is 0");
  return report->differing_pixels > 0 ? int(ErrorKind::comparison) : 0;
}

Expected<int> run_bench(BenchOptions o) {
  if (o.quiet) log::set_level(log::Level::warning);
  if (auto taken = take_stability_file(o); !taken) return std::unexpected(taken.error());
  if (auto good = check_options(o); !good) return std::unexpected(good.error());
  if (!o.compare.empty()) return run_compare(o);
  if (!o.from.empty()) return run_from_rows(o);
  if (o.suite == "exactness") return run_exactness(o);
  if (o.suite == "stillness") return run_stillness(o);
  if (o.suite == "stability") return run_stability(o);
  if (o.error) return run_errors(o);
  return run_measure(o);
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto o = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "Measure techniques, light counts, sizes and knobs; compare results");
  add_bench_options(*command, *o);
  command->callback([o, &action] { action = [o] { return run_bench(*o); }; });
}

}  // namespace candela::cli
