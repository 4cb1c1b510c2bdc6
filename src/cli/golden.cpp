#include <CLI/CLI.hpp>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/scratch_folder.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/golden_run.h"
#include "cli/golden_update.h"
#include "cli/input_options.h"
#include "cli/report_files.h"
#include "cli/signals.h"
#include "farm/quote.h"
#include "render/frame_names.h"
#include "report/golden_report.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Kind = GoldenOutcome::Kind;

struct GoldenOptions {
  std::string root = "golden", assets, filter, first, report, why, device_class, device;
  bool validate = false, json = false, quiet = false, allow_blank = false, exact = false;
};

// The assets lie beside the repository unless said otherwise.
fs::path assets_of(const GoldenOptions& o) {
  return o.assets.empty()
             ? (fs::absolute(o.root).lexically_normal().parent_path() / "../shared/assets").lexically_normal()
             : fs::path(o.assets);
}

Expected<std::vector<GoldenManifest>> goldens_of(const GoldenOptions& o) {
  std::string root = o.root;
  while (root.size() > 1 && root.ends_with('/')) root.pop_back();
  auto goldens = read_goldens(root, assets_of(o), o.filter);
  if (!goldens || o.first.empty()) return goldens;
  const auto first = std::ranges::find(*goldens, o.first, &GoldenManifest::name);
  if (first == goldens->end()) return fail(ErrorKind::usage, "--from-golden", "there is no golden '{}'", o.first);
  goldens->erase(goldens->begin(), first);
  return goldens;
}

// After a signal. next: the first golden that was not looked at.
int interrupted(const HeldSignals& held, size_t done, size_t total, const std::string& next, const char* what) {
  log::warning("interrupted after {} of {} goldens, {}; the same command with --from-golden {} goes on", done, total,
               what, shell_quoted(next));
  return 128 + held.pending();
}

RunSettings run_settings(const GoldenOptions& o) { return {.device = o.device, .validate = o.validate}; }

std::string verdict(const GoldenOutcome& outcome) {
  if (outcome.kind == Kind::skipped) return "skipped";
  return outcome.missing ? "missing golden" : std::string(gate_level_name(outcome.gate.level));
}

GoldenRow report_row(const GoldenManifest& golden, const GoldenOutcome& outcome) {
  GoldenRow row;
  row.name = golden.name;
  row.verdict = verdict(outcome);
  row.passed = outcome.kind != Kind::failed;
  row.warned = outcome.warned();
  row.blank = outcome.gate.blank;
  row.message = outcome.message;
  row.device_class = outcome.device.device_class, row.device = outcome.device.device;
  row.time_s = outcome.seconds;
  row.metrics = outcome.gate.comparison.metrics;
  row.golden = outcome.golden_png, row.actual = outcome.actual_png;
  row.heat_map = outcome.heat_map;
  row.pictures = outcome.pictures;
  if (!outcome.gate.comparison.flip_map.empty()) {
    const GateLimits& l = outcome.limits;
    const auto& metrics = outcome.gate.comparison.metrics;
    const auto metric = [&](const char* name) { return metrics.contains(name) ? metrics.at(name) : NAN; };
    // Without warning limits of their own all differences that FLIP is asked about are warned of.
    const GateLimits::Warn warn = l.warn.value_or(GateLimits::Warn{});
    row.bounds = {{"FLIP, mean", metric("flip"), l.flip_mean, warn.flip_mean},
                  {"FLIP, 99th percentile", outcome.gate.flip_p99, l.flip_p99, warn.flip_p99},
                  {"largest difference", outcome.gate.largest, NAN, warn.max_abs, l.max_abs},
                  {fmt::format("share of pixels off by more than {:.4g}", l.small_abs), outcome.gate.small_fraction,
                   NAN, NAN, l.small_fraction}};
  }
  return row;
}

Expected<void> write_golden_report(const fs::path& folder, const std::vector<GoldenRow>& rows, const std::string& sum) {
  std::vector<std::string> devices;
  for (const GoldenRow& row : rows) devices.push_back(row.device);
  const PageHead head{.title = "candela goldens: " + sum,
                      .findings = {},
                      .facts = {{"device", distinct(devices)}, {"program", this_program()}},
                      .picture = {}};
  if (auto written = write_golden_html(folder / "index.html", rows, head); !written) return written;
  return write_golden_junit(folder / "junit.xml", rows, "candela goldens");
}

Json outcome_json(const GoldenManifest& golden, const GoldenOutcome& outcome) {
  Json metrics = Json::object();
  for (const auto& [name, value] : outcome.gate.comparison.metrics) metrics[name] = value;
  return {{"name", golden.name},
          {"verdict", verdict(outcome)},
          {"pass", outcome.kind != Kind::failed},
          {"warned", outcome.warned()},
          {"message", outcome.message},
          {"device", outcome.device.device},
          {"device_class", outcome.device.device_class},
          {"driver", outcome.device.driver},
          {"same_device", outcome.same_device},
          {"digest", outcome.digest},
          {"metrics", metrics},
          {"seconds", outcome.seconds}};
}

// What a report may hold of each golden (golden_run.cpp), and that it is no file of a golden.
Expected<void> declare_report(const std::string& folder, const std::vector<GoldenManifest>& goldens) {
  if (folder.empty()) return {};
  std::vector<NamedFile> files;
  for (const GoldenManifest& golden : goldens) {
    std::error_code failed;
    for (fs::directory_iterator entry(golden.folder, failed), end; !failed && entry != end; entry.increment(failed))
      note_read({"--root", entry->path()});
    for (const std::string ending : {golden.ending(), "-new.png", "-golden.png", "-heat.png"})
      files.push_back({"--report", fs::path(folder) / (golden.name + ending)});
  }
  if (auto fine = declare_outputs(files); !fine) return fine;
  return check_outputs();
}

Expected<int> run_check(const GoldenOptions& o) {
  if (o.quiet) log::set_level(log::Level::warning);
  const auto goldens = goldens_of(o);
  if (!goldens) return std::unexpected(goldens.error());
  if (auto fine = declare_report(o.report, *goldens); !fine) return std::unexpected(fine.error());
  const ScratchFolder scratch("golden");
  if (!o.report.empty())
    if (auto ready = prepare_output(fs::path(o.report) / "index.html"); !ready) return std::unexpected(ready.error());
  std::vector<std::vector<std::string>> rows = {{"GOLDEN", "VERDICT", "FLIP", "SECONDS", "MESSAGE"}};
  Json list = Json::array();
  std::map<Kind, int> count;
  int warned = 0, others = 0;
  std::vector<GoldenRow> report;
  const HeldSignals held;
  size_t done = 0;
  for (const GoldenManifest& golden : *goldens) {
    if (held.pending() != 0) break;
    ++done;
    const GoldenOutcome outcome = check_golden(golden, {run_settings(o), o.allow_blank, o.exact},
                                               o.report.empty() ? scratch.path() : fs::path(o.report));
    const std::string line =
        golden.name + ": " + verdict(outcome) + (outcome.message.empty() ? "" : ": " + outcome.message);
    log::write(outcome.warned() ? log::Level::warning : log::Level::info, line);
    ++count[outcome.kind];
    warned += outcome.warned();
    others += !outcome.digest.empty() && !outcome.same_device;
    const auto flip = outcome.gate.comparison.metrics.find("flip");
    rows.push_back({golden.name, verdict(outcome),
                    flip == outcome.gate.comparison.metrics.end() ? "" : fmt::format("{:.5f}", flip->second),
                    fmt::format("{:.2f}", outcome.seconds), outcome.message});
    list.push_back(outcome_json(golden, outcome));
    // Skipped ones are counted in the table; in a report they would look like passes.
    if (outcome.kind != Kind::skipped) report.push_back(report_row(golden, outcome));
  }
  if (others > 0) log::info("{} goldens were made on another device or driver: what their limits allow passes", others);
  std::string sum = fmt::format("{} passed ({} with a warning), {} failed, {} skipped", count[Kind::passed], warned,
                                count[Kind::failed], count[Kind::skipped]);
  if (done < goldens->size()) sum += fmt::format(", {} not looked at: interrupted", goldens->size() - done);
  if (count[Kind::skipped] > 0)
    log::warning("{} goldens skipped: no assets at {}", count[Kind::skipped], assets_of(o).string());
  auto printed = o.json ? print_json({{"goldens", list},
                                      {"passed", count[Kind::passed]},
                                      {"warned", warned},
                                      {"failed", count[Kind::failed]},
                                      {"skipped", count[Kind::skipped]}})
                        : print(table_text(rows) + sum + "\n");
  if (printed && !o.report.empty()) printed = write_golden_report(o.report, report, sum);
  if (printed && !o.report.empty())
    printed = write_file_atomically(fs::path(o.report) / golden_run_file, Json({{"goldens", list}}).dump(2) + "\n");
  if (!printed) return std::unexpected(printed.error());
  if (done < goldens->size())
    return interrupted(held, done, goldens->size(), (*goldens)[done].name, "whose verdicts are above");
  return count[Kind::failed] > 0 ? int(ErrorKind::comparison) : 0;
}

Expected<int> run_update(const GoldenOptions& o) {
  if (o.quiet) log::set_level(log::Level::warning);
  if (o.why.empty()) return fail(ErrorKind::usage, "--why", "say why the pictures change; it is kept in CHANGES.md");
  const auto goldens = goldens_of(o);
  if (!goldens) return std::unexpected(goldens.error());
  const ScratchFolder scratch("golden");
  std::vector<std::string> changed;
  GoldenDevice picture;
  Expected<void> failed;
  const HeldSignals held;
  size_t done = 0;
  for (const GoldenManifest& golden : *goldens) {
    if (held.pending() != 0) break;
    ++done;
    if (golden.missing_assets) {
      log::warning("{} skipped: no assets at {}", golden.name, assets_of(o).string());
      continue;
    }
    const auto updated =
        update_golden(golden, {run_settings(o), o.allow_blank, o.device_class}, scratch.path(), picture);
    if (!updated) {
      failed = std::unexpected(updated.error());
      break;
    }
    log::info("{}: {}", golden.name, *updated ? "changed" : "as it was");
    if (*updated) changed.push_back(golden.name);
  }
  // What was written before an error is noted too.
  if (!changed.empty())
    if (auto noted = note_changes(goldens->front().folder.parent_path(), changed, picture, o.why); !noted)
      return std::unexpected(noted.error());
  if (!failed) return std::unexpected(failed.error());
  if (done < goldens->size())
    return interrupted(held, done, goldens->size(), (*goldens)[done].name, "those that changed are kept and noted");
  log::info("{} of {} goldens changed", changed.size(), goldens->size());
  return 0;
}

void add_shared(CLI::App& command, GoldenOptions& o) {
  command.add_option("--root", o.root, "Folder of the goldens")->capture_default_str()->type_name("DIR");
  command
      .add_option("--assets", o.assets,
                  "Folder of scenes named assets:...; by default ../shared/assets beside the repository")
      ->type_name("DIR");
  add_input_options(command);
  command.add_option("--filter", o.filter, "Only goldens with this in their name")->type_name("TEXT");
  command.add_option("--from-golden", o.first, "Only this golden and those after it")->type_name("NAME");
  command.add_option("--device", o.device, "As for render")->type_name("DEVICE");
  command.add_flag("--validate", o.validate,
                   "Khronos validation layer with synchronization checks; a message fails the golden");
  command.add_flag("--allow-blank", o.allow_blank, "Goldens in which nothing is drawn are not refused");
  command.add_flag("--quiet", o.quiet, "Only warnings and errors on stderr");
}

}  // namespace

void add_golden(CLI::App& app, Action& action) {
  auto o = std::make_shared<GoldenOptions>();
  CLI::App* golden = app.add_subcommand("golden", "Compare renders with kept pictures, or keep new ones");
  golden->require_subcommand(1);
  CLI::App* check =
      golden->add_subcommand("check", "Render every golden and compare; exit 1 when one fails or is missing");
  add_shared(*check, *o);
  check
      ->add_option("--report", o->report,
                   "Folder for an HTML page of failures, a JUnit file and what `golden accept` takes")
      ->type_name("DIR");
  check->add_flag("--exact", o->exact,
                  "Only identical pixels pass, on every device, not only on the one that a golden was made on");
  check->add_flag("--json", o->json, "As JSON");
  check->callback([o, &action] { action = [o] { return run_check(*o); }; });
  add_golden_accept(*golden, action);
  add_golden_add(*golden, action);
  CLI::App* update = golden->add_subcommand("update", "Render every golden and keep what changed");
  add_shared(*update, *o);
  update->add_option("--why", o->why, "Why they change; noted in CHANGES.md")->type_name("TEXT");
  update
      ->add_option("--device-class", o->device_class,
                   "Keep a picture for this class of device beside one made on another class")
      ->type_name("NAME");
  update->callback([o, &action] { action = [o] { return run_update(*o); }; });
}

}  // namespace candela::cli
