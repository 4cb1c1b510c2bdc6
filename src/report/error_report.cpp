#include "report/error_report.h"

#include <set>

#include "bench/error_analysis.h"
#include "bench/error_truth.h"
#include "report/error_parts_table.h"
#include "report/error_rows.h"
#include "report/error_tables.h"
#include "report/markup.h"
#include "report/plot.h"

namespace candela {
namespace {

constexpr const char* metric_labels[][2] = {{"relmse", "relMSE (squared error over squared radiance)"},
                                            {"hdr-flip", "HDR-FLIP, mean (0: equal, 1: most different)"}};

std::string label_of(const std::string& metric) {
  for (const auto& [name, label] : metric_labels)
    if (metric == name) return label;
  return metric;
}

std::string front_figure(const ErrorPlace& place, const std::string& reference, const std::string& metric,
                         Figures& figures) {
  ScatterPlot plot{.title = fmt::format("{} against {}", metric, reference),
                   .x_label = "time of a frame on the device, ms: median with its 95 % confidence interval",
                   .y_label = label_of(metric)};
  for (const ErrorPoint& point : error_points(place.rows, reference, metric)) {
    const std::string& technique = point.row->technique;
    auto group = std::find(plot.groups.begin(), plot.groups.end(), technique);
    if (group == plot.groups.end()) group = plot.groups.insert(plot.groups.end(), technique);
    using Standing = ErrorPoint::Standing;
    plot.points.push_back({.label = error_names(*point.row),
                           .at = {point.ms, point.error, point.ms_ci, point.error_ci},
                           .group = size_t(group - plot.groups.begin()),
                           .dimmed = point.standing == Standing::dominated,
                           .ring = point.standing == Standing::unclear});
    if (const auto& noise = error_against(*point.row, reference)->noise; noise && metric == "relmse")
      plot.floor_y = noise->relmse;
  }
  return figures.add(plot.title, plot_script(plot));
}

std::string sentences(const ErrorPlace& place) {
  std::string html;
  for (const std::string& defect : error_defects(place.rows))
    html += "<p class=\"error\">" + escape_markup(defect) + "</p>\n";
  html += "<ul>\n";
  for (const std::string& sentence : cheapest_sentences(place.rows, error_bounds))
    html += "<li>" + escape_markup(sentence) + "</li>\n";
  html += "</ul>\n<ul class=\"faint\">\n";
  if (place.rows.front()->views > 1)
    html += fmt::format(
        "<li>times and errors are means over {} views; what is sure is decided by pairs of rounds and of views, so "
        "that "
        "at most one such sentence in twenty is false (docs/understanding/deciding.md)</li>\n",
        place.rows.front()->views);
  else
    html += "<li class=\"note\">one view: its errors say little about others</li>\n";
  for (const NoiseVerdict& verdict : noise_verdicts(place.rows))
    html += fmt::format("<li{}>{}</li>\n", verdict.enough ? "" : " class=\"note\"", escape_markup(verdict.sentence));
  return html + "</ul>\n";
}

std::string order_text(const KnobStudy& study) {
  if (study.fit.points < 2) return "no order of convergence: fewer than two of its numbers have an error";
  return fmt::format("rmse = {:.3g} · value^{:.2f} over {} values, R² {:.3f}{}", study.fit.factor, study.fit.exponent,
                     study.fit.points, study.r_squared,
                     study.fit.points == 2 ? " (two points: no test of the law)" : "");
}

// The law of each knob that has one, with the techniques that follow it as colours.
std::string order_plots(const std::vector<KnobStudy>& studies, Figures& figures) {
  std::string html, list;
  std::set<std::string> drawn;
  for (const KnobStudy& study : studies) {
    if (study.kind != "error") continue;
    list +=
        "<li>" + escape_markup(fmt::format("{}, {}: {}", study.knob, study.technique, order_text(study))) + "</li>\n";
    if (study.fit.points < 2 || !drawn.insert(study.knob).second) continue;
    ScatterPlot plot{.title = study.knob + ": order of convergence",
                     .x_label = study.knob,
                     .y_label = "RMSE against the technique's exact picture",
                     .points = {},
                     .groups = {},
                     .stairs = false};
    for (const KnobStudy& other : studies) {
      if (other.knob != study.knob) continue;
      for (const KnobStudy::Value& v : other.values)
        if (v.value > 0) plot.points.push_back({v.text, {v.value, v.rmse, {}, {}}, plot.groups.size()});
      plot.groups.push_back(other.technique);
    }
    for (const double x : {study.fit.first_x, study.fit.last_x})
      plot.curve.emplace_back(x, study.fit.factor * std::pow(x, study.fit.exponent));
    html += figures.add(plot.title, plot_script(plot), order_text(study));
  }
  return (list.empty() ? list : "<ul>\n" + list + "</ul>\n") + html;
}

// Pictures that several techniques share are shown once.
std::string strips(const ErrorPlace& place) {
  std::vector<std::pair<const BenchRow*, std::vector<std::string>>> shown;
  for (const BenchRow* row : place.rows) {
    if (row->strip.empty()) continue;
    const auto same =
        std::find_if(shown.begin(), shown.end(), [&](const auto& s) { return s.first->strip == row->strip; });
    (same == shown.end() ? shown.emplace_back(row, std::vector<std::string>{}) : *same)
        .second.push_back(error_setting(*row));
  }
  std::string html;
  for (const auto& [row, settings] : shown)
    html += fmt::format(
        "<figure class=\"strip\"><div class=\"thirds\"><span>{}</span><span>result</span><span>FLIP: bright is "
        "wrong</span></div><img src=\"data:image/png;base64,{}\" "
        "alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
        escape_markup(row->suite == "whole" ? truth_of(*row) : "the technique's exact picture"), base64(row->strip),
        escape_markup(settings.front()),
        escape_markup(settings.front() + (settings.size() > 1
                                              ? fmt::format(" (and {} more with the same picture)", settings.size() - 1)
                                              : "")));
  return html.empty() ? html : "<h3>Reference, result, FLIP</h3>\n" + html;
}

}  // namespace

std::string error_html(const BenchRun& run, Figures& figures) {
  std::string html;
  for (const ErrorPlace& place : error_places(run)) {
    html += fmt::format("<section>\n<h2>Error against time: {}</h2>\n", escape_markup(place.name));
    html += sentences(place);
    html +=
        "<h3>Fronts</h3>\n<p>Pale: another setting is surely quicker and no worse. Open: by its numbers another is no "
        "slower and no worse, but the two are not distinguishable.</p>\n";
    const std::string truth = truth_of(place.rows);
    html += front_figure(place, truth, "relmse", figures);
    html += front_figure(place, truth, "hdr-flip", figures);
    std::string others;
    for (const std::string& reference : error_reference_names())
      if (reference != truth && !error_points(place.rows, reference, "relmse").empty())
        others += front_figure(place, reference, "relmse", figures);
    if (!others.empty()) html += folded("Against other references", others);
    html += strips(place);
    html +=
        "<h3>Techniques at each quality</h3>\n<p>All errors are relMSE. <i>Sampling</i> is the distance from the same "
        "technique at its exact end, <i>model</i> the exact end's own distance from the reference, <i>total</i> the "
        "row's. The three do not add up: errors may cancel. What adds is <i>where the error lies</i>, by "
        "pixels.</p>\n" +
        totals_table(place);
    if (const std::string parts = parts_table(place); !parts.empty())
      html +=
          "<h3>Where the error lies</h3>\n<p>In the first view: squared errors over the square of the reference's "
          "beauty plus 0.01. <i>edges</i>: of beauty, where another object or a crease is in the pixel or beside it; "
          "the "
          "terms: of each of them, elsewhere. Against <i>exact</i> what is left off edges is textures and shading "
          "within "
          "a pixel. The parts need not add up to <i>all</i>: errors of two terms may cancel.</p>\n" +
          parts;
    const std::vector<BenchRow> named = rows_by_name(place.rows);
    std::vector<const BenchRow*> by_name;
    for (const BenchRow& row : named) by_name.push_back(&row);
    if (const auto studies = knob_studies(by_name); !studies.empty())
      html += "<h3>Each knob alone, against the technique's exact picture</h3>\n" + order_plots(studies, figures) +
              folded("All values of all knobs", knob_table(studies));
    html += folded("All errors", error_rows_table(place)) + "</section>\n";
  }
  if (html.empty()) return html;
  return html + folded("Knobs that no row sweeps", list_html(unswept_knobs(run.rows), "note"));
}

}  // namespace candela
