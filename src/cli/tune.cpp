#include "bench/tune.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/log.h"
#include "bench/error_analysis.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/report_files.h"
#include "cli/signals.h"
#include "report/tune_report.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

struct TuneCommand {
  JobOptions job;
  MomentOptions moment;
  double seconds = 120;
  std::string report;
};

constexpr std::array<double, 5> error_levels = {0.1, 0.03, 0.01, 0.003, 0.001};

// Whole frame rates whose time lies between the fastest and the slowest of the front.
std::vector<double> time_levels(const TuneReport& report) {
  std::vector<double> levels;
  const auto front = tune_front(report);
  for (const double rate : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 24.0, 30.0, 60.0, 120.0, 240.0, 480.0, 1000.0, 2000.0})
    if (!front.empty() && 1000 / rate >= front.front()->ms.high && 1000 / rate <= 4 * front.back()->ms.high)
      levels.push_back(1000 / rate);
  return levels;
}

std::vector<std::string> row_of(const std::string& wanted, const TuneChoice& choice, double bound,
                                const std::string& otherwise) {
  if (!choice.trial) return {wanted, "", "", "", otherwise};
  const TuneTrial& t = *choice.trial;
  return {wanted, fmt::format("{:.3g} ({:.3g} to {:.3g})", t.median_ms, t.ms.low, t.ms.high),
          bounded_text(t.relmse, bound), fmt::format("{:.3f}", t.flip), t.options};
}

std::string text_of(const TuneReport& report, const Job& job) {
  std::vector<std::vector<std::string>> rows = {{"WANTED", "MS (95 %)", "RELMSE", "FLIP", "OPTIONS"}};
  const TuneTrial* least = least_error(report);
  for (const TuneChoice& c : cheapest_within(report, error_levels))
    rows.push_back(row_of(
        fmt::format("relmse <= {}", c.wanted), c, c.wanted,
        least ? "none was found: the least is " + bounded_text(least->relmse, c.wanted) : "nothing was measured"));
  if (least && least->relmse > error_levels.back()) rows.push_back(row_of("the least", {0, least}, 0, ""));
  for (const TuneChoice& c : most_exact_within(report, time_levels(report)))
    rows.push_back(row_of(fmt::format("{:.3g} ms", c.wanted), c, 0, "none is that quick"));
  std::string text = table_text(rows);
  text += fmt::format(
      "{}x{}, milliseconds of {}, {} settings in {:.0f} s; errors against the reference '{}' of {} samples a pixel, "
      "whose noise\nmakes a relmse of {:.2g}\n",
      job.width_px, job.height_px, report.device, report.trials.size(), report.wall_s, report.reference,
      report.reference_spp, report.noise);
  for (const std::string& note : report.notes) text += note + "\n";
  return text;
}

Json choices_json(const std::vector<TuneChoice>& choices, const char* wanted) {
  Json list = Json::array();
  for (const TuneChoice& c : choices)
    list.push_back({{wanted, c.wanted}, {"options", c.trial ? Json(c.trial->options) : Json()}});
  return list;
}

Json json_of(const TuneReport& report) {
  Json j;
  j["device"] = report.device;
  j["wall_s"] = report.wall_s;
  j["reference"] = {{"name", report.reference}, {"spp", report.reference_spp}, {"relmse_of_noise", report.noise}};
  j["errors"] = choices_json(cheapest_within(report, error_levels), "relmse");
  j["times"] = choices_json(most_exact_within(report, time_levels(report)), "ms");
  j["trials"] = Json::array();
  for (const TuneTrial& t : report.trials) {
    Json trial = {{"options", t.options}};
    if (!t.failed.empty()) trial["failed"] = t.failed;
    if (!t.same_as.empty()) trial["same_as"] = t.same_as;
    if (t.usable())
      trial.update({{"median_ms", t.median_ms},
                    {"ms_ci", {t.ms.low, t.ms.high}},
                    {"gpu_ms", t.gpu_ms},
                    {"relmse", t.relmse},
                    {"flip", t.flip}});
    j["trials"].push_back(trial);
  }
  j["notes"] = report.notes;
  return j;
}

Expected<int> run_tune(CLI::App& command, TuneCommand& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  if (!(o.seconds > 0) || !std::isfinite(o.seconds))
    return fail(ErrorKind::usage, "--seconds", "{} s is not a time to search; give more than 0", o.seconds);
  for (const char* option : {"--technique", "--quality", "--set", "--samples"})
    if (command.get_option(option)->count() > 0)
      return fail(ErrorKind::usage, option, "is what tune looks for; leave it out");
  const auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  const auto settings = run_settings_of(o.job);
  if (!settings) return std::unexpected(settings.error());
  const auto moment = moment_of(o.job, o.moment);
  if (!moment) return std::unexpected(moment.error());
  if (auto ready = prepare_report(o.report); !ready) return std::unexpected(ready.error());
  HeldSignals held;
  const auto report =
      tune({*job, moment->time_s, o.seconds, !o.report.empty()}, *settings, [&] { return held.pending() != 0; });
  if (!report) return std::unexpected(report.error());
  const auto page = [&](Figures& figures) {
    return tune_html(*report, *job, std::filesystem::path(job->scene).filename().string(),
                     cheapest_within(*report, error_levels), most_exact_within(*report, time_levels(*report)),
                     this_program(), figures);
  };
  const std::string json = json_of(*report).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (auto written = write_report(o.report, {{"tune.json", json}}, page); !written)
    return std::unexpected(written.error());
  if (auto printed = o.job.json ? print_json(json_of(*report)) : print(text_of(*report, *job)); !printed)
    return std::unexpected(printed.error());
  if (held.pending()) return 128 + held.pending();
  return 0;
}

}  // namespace

void add_tune(CLI::App& app, Action& action) {
  auto o = std::make_shared<TuneCommand>();
  CLI::App* command =
      app.add_subcommand("tune", "Find the cheapest settings for several errors, on this scene and device");
  add_job_options(*command, o->job);
  add_moment_options(*command, o->moment);
  command
      ->add_option("--seconds", o->seconds,
                   "Time for everything, also for opening and the traced reference; a frame that was begun is finished")
      ->capture_default_str()
      ->type_name("SECONDS");
  command->add_option("--report", o->report, "Folder for an HTML page, its figures and the result as JSON")
      ->type_name("DIR");
  add_run_options(*command, o->job);
  command->callback([command, o, &action] { action = [command, o] { return run_tune(*command, *o); }; });
}

}  // namespace candela::cli
