#include "report/error_report.h"

#include "bench/error_analysis.h"
#include "bench/error_sweep.h"
#include "report/error_rows.h"
#include "report/golden_report.h"
#include "report/scatter.h"

namespace candela {
namespace {

std::string cell(const std::string& text, const char* kind = "") {
  return fmt::format("<td{}>{}</td>", *kind ? fmt::format(" class=\"{}\"", kind) : "", escape_markup(text));
}
std::string head(std::initializer_list<const char*> names) {
  std::string html = "<div class=\"wide\"><table>\n<tr>";
  for (const char* name : names) html += fmt::format("<th class=\"text\">{}</th>", escape_markup(name));
  return html + "</tr>\n";
}
std::string number(std::optional<double> value) { return value ? fmt::format("{:.3g}", *value) : ""; }

std::string front_svg(const ErrorPlace& place, const std::string& reference, const std::string& metric) {
  Scatter scatter{.title = fmt::format("{} against {}", metric, reference), .x_label = "GPU ms, median", .y_label = metric};
  for (const ErrorPoint& point : error_points(place.rows, reference, metric)) {
    const std::string& technique = point.row->technique;
    auto group = std::find(scatter.groups.begin(), scatter.groups.end(), technique);
    if (group == scatter.groups.end()) group = scatter.groups.insert(scatter.groups.end(), technique);
    scatter.points.push_back({error_setting(*point.row), point.ms, point.error, size_t(group - scatter.groups.begin()), point.dominated});
    if (const auto& noise = error_against(*point.row, reference)->noise; noise && metric == "relmse") scatter.floor_y = noise->relmse;
  }
  return scatter.points.empty() ? std::string() : "<div class=\"wide\">" + scatter_svg(scatter) + "</div>\n";
}

std::string sentences(const ErrorPlace& place) {
  std::string html = "<ul>\n";
  for (const char* reference : {open_reference_name, "direct", "path"})
    for (const double bound : error_bounds)
      html += "<li>" + escape_markup(cheapest_sentence(place.rows, reference, "relmse", bound)) + "</li>\n";
  return html + "</ul>\n";
}

std::string knob_table(const std::vector<KnobStudy>& studies) {
  std::string html = head({"knob", "value", "GPU ms ± MAD", "relmse", "rmse", "worth its time?"});
  for (const KnobStudy& study : studies)
    for (const KnobStudy::Value& v : study.values)
      html += "<tr>" + cell(study.knob, "text") + cell(v.text + (v.text == study.advised ? " (advised)" : ""), "text") +
              cell(fmt::format("{:.3f} ± {:.3f}", v.ms, v.mad_ms)) + cell(number(v.relmse)) + cell(number(v.rmse)) +
              cell(v.verdict, v.dominated ? "text faint" : "text") + "</tr>\n";
  html += "</table></div>\n<ul>\n";
  for (const KnobStudy& study : studies) {
    std::string order = study.fit.points >= 2 ? fmt::format("rmse = {:.3g} · value^{:.2f} over {} values, R² {:.3f}{}", study.fit.factor,
                                                            study.fit.exponent, study.fit.points, study.r_squared,
                                                            study.fit.points == 2 ? " (two points: no test of the law)" : "")
                                              : "no order of convergence: fewer than two values have an error";
    html += "<li>" + escape_markup(study.knob + ": " + order) + "</li>\n";
  }
  return html + "</ul>\n";
}

std::string rows_table(const ErrorPlace& place) {
  std::string html = head({"setting", "sweep", "GPU ms ± MAD", "frame ms", "against", "relmse", "relmse-trimmed", "rmse", "mae", "max", "p99", "flip",
                           "hdr-flip", "ssim", "noise (relmse)"});
  for (const BenchRow* row : place.rows)
    for (const PictureError& error : row->errors) {
      const Summary gpu = summary(row->gpu.ms);
      html += "<tr>" + cell(error_setting(*row), "text") + cell(row->suite, "text") + cell(fmt::format("{:.3f} ± {:.3f}", gpu.median, gpu.mad)) +
              cell(fmt::format("{:.3f}", summary(row->frame.ms).median)) + cell(error.reference, "text");
      for (const char* metric : {"relmse", "relmse-trimmed", "rmse", "mae", "max", "p99", "flip", "hdr-flip", "ssim"}) {
        const bool noise = std::string_view(metric) == "relmse" && error.noise && error_of(*row, error.reference, metric).value_or(1e300) <= error.noise->relmse;
        html += cell(number(error_of(*row, error.reference, metric)) + (noise ? " (below noise)" : ""), noise ? "faint" : "");
      }
      html += cell(error.noise ? fmt::format("{:.3g}", error.noise->relmse) : "") + "</tr>\n";
    }
  return html + "</table></div>\n";
}

std::string strips(const ErrorPlace& place) {
  std::string html;
  for (const BenchRow* row : place.rows)
    if (!row->strip.empty())
      html += fmt::format("<figure><img style=\"max-width:960px\" src=\"data:image/png;base64,{}\" alt=\"\"/><figcaption>{}</figcaption></figure>\n",
                          base64(row->strip),
                          escape_markup(fmt::format("{} ({}): {}, result, FLIP", error_setting(*row), row->suite,
                                                    row->suite == "whole" ? open_reference_name : exact_reference)));
  return html.empty() ? html : "<h3>Reference, result, FLIP</h3>\n" + html;
}

}  // namespace

std::string error_html(const BenchRun& run) {
  std::string html;
  for (const ErrorPlace& place : error_places(run)) {
    html += fmt::format("<section>\n<h2>Error against time: {}</h2>\n", escape_markup(place.name));
    html += sentences(place);
    for (const char* reference : {open_reference_name, "direct", "path", exact_reference}) html += front_svg(place, reference, "relmse");
    html += front_svg(place, open_reference_name, "hdr-flip");
    if (const auto studies = knob_studies(place.rows); !studies.empty())
      html += "<h3>Each knob alone, against the exact picture</h3>\n" + knob_table(studies);
    html += "<h3>All errors</h3>\n" + rows_table(place) + strips(place) + "</section>\n";
  }
  return html;
}

}  // namespace candela
