#include "report/tune_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/markup.h"
#include "report/page.h"
#include "report/plot.h"

namespace candela {
namespace {

std::string ms_text(const TuneTrial& t) {
  return fmt::format("{:.3g} ms ({:.3g} to {:.3g})", t.median_ms, t.ms.low, t.ms.high);
}

// One sentence for the tightest error that a setting meets.
std::vector<PageFinding> findings_of(const std::vector<TuneChoice>& errors) {
  std::vector<PageFinding> findings;
  const TuneTrial* before = nullptr;
  for (const TuneChoice& c : errors) {
    if (!c.trial) {
      findings.push_back({fmt::format("no setting that was tried has relmse of at most {}", c.wanted)});
      break;
    }
    if (c.trial == before) findings.pop_back();
    findings.push_back({fmt::format("for relmse of at most {} the cheapest is {}: {}", c.wanted, c.trial->options,
                                    ms_text(*c.trial))});
    before = c.trial;
  }
  return findings;
}

std::string choices_table(const char* wanted, const std::vector<TuneChoice>& choices, const char* format) {
  std::vector<std::vector<TableCell>> rows;
  for (const TuneChoice& c : choices) {
    std::vector<TableCell> row = {{fmt::format(fmt::runtime(format), c.wanted)}};
    if (c.trial)
      row.insert(row.end(), {{ms_text(*c.trial)},
                             {fmt::format("{:.2g}", c.trial->relmse)},
                             {fmt::format("{:.3f}", c.trial->flip)},
                             text_cell(c.trial->options)});
    else
      row.insert(row.end(), {{""}, {""}, {""}, text_cell("none was found")});
    rows.push_back(std::move(row));
  }
  return rows.empty() ? "" : html_table({wanted, "time (95 %)", "relmse", "FLIP", "options"}, 0, rows);
}

std::string trials_table(const TuneReport& report) {
  std::vector<std::vector<TableCell>> rows;
  for (const TuneTrial& t : report.trials) {
    if (t.usable())
      rows.push_back({{ms_text(t)},
                      {fmt::format("{:.3g}", t.relmse)},
                      {fmt::format("{:.4f}", t.flip)},
                      text_cell(t.options),
                      text_cell("")});
    else
      rows.push_back({{""},
                      {""},
                      {""},
                      text_cell(t.options),
                      text_cell(t.failed.empty() ? "the same as " + t.same_as : t.failed)});
  }
  return html_table({"time (95 %)", "relmse", "FLIP", "options", ""}, 0, rows);
}

ScatterPlot plot_of(const TuneReport& report) {
  ScatterPlot plot{.title = "Error against time",
                   .x_label = "time of a frame on the device, ms: median with its 95 % confidence interval",
                   .y_label = "relMSE against the traced reference",
                   .points = {},
                   .groups = {}};
  const std::vector<const TuneTrial*> front = tune_front(report);
  for (const TuneTrial& t : report.trials) {
    if (!t.usable()) continue;
    auto group = std::find(plot.groups.begin(), plot.groups.end(), t.job.technique);
    if (group == plot.groups.end()) group = plot.groups.insert(plot.groups.end(), t.job.technique);
    plot.points.push_back({.label = t.options,
                           .at = {t.median_ms, t.relmse, t.ms, {}},
                           .group = size_t(group - plot.groups.begin()),
                           .dimmed = std::find(front.begin(), front.end(), &t) == front.end()});
  }
  return plot;
}

}  // namespace

std::string tune_html(const TuneReport& report, const Job& job, const std::string& scene,
                      const std::vector<TuneChoice>& errors, const std::vector<TuneChoice>& times,
                      const std::string& program, Figures& figures) {
  PageHead head{.title = "candela tune: " + scene, .findings = findings_of(errors)};
  head.facts = {{"frame", fmt::format("{}, {}x{}", scene, job.width_px, job.height_px)},
                {"device", report.device},
                {"program", program},
                {"search", fmt::format("{} settings in {:.0f} s", report.trials.size(), report.wall_s)},
                {"errors", fmt::format("against the traced reference '{}' of {} samples a pixel, whose noise makes a "
                                       "relmse of {:.2g}",
                                       report.reference, report.reference_spp, report.noise)}};
  head.picture = report.picture.empty()
                     ? "There is no picture of the scene: no frame of it was drawn."
                     : figures.add_picture(scene, report.picture, tune_front(report).back()->options);
  std::string html;
  if (!figures.draws()) html += "<p class=\"note\">gnuplot is not installed: there are no figures, only tables.</p>\n";
  const ScatterPlot plot = plot_of(report);
  html += "<h2>Settings</h2>\n" +
          figures.add(plot.title, plot_script(plot), "Pale: another setting that was tried is quicker and no worse.");
  html += "<h3>The cheapest for an error</h3>\n" + choices_table("relmse at most", errors, "{}");
  if (const std::string table = choices_table("ms at most", times, "{:.3g}"); !table.empty())
    html += "<h3>The most exact for a time</h3>\n" + table;
  return page_html(head,
                   html + folded("All settings that were tried", trials_table(report)) + notes_html(report.notes));
}

}  // namespace candela
