#include "report/compare_report.h"

#include "report/golden_report.h"

namespace candela {

std::string compare_html(const CompareReport& report) {
  const std::string title = escape_markup("candela compare: " + report.test + " against " + report.reference);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
      "</title><style>body{font:14px sans-serif;margin:2em;background:#fff;color:#222}h1{font-size:1.2em}"
      "table{border-collapse:collapse}td,th{text-align:left;padding:.1em 1em .1em 0}"
      ".broken{color:#c22;font-weight:bold}" +
      viewer_style() + "</style></head><body>\n<h1>" + title + "</h1>\n";
  if (!report.limits.empty()) {
    html += "<table><tr><th>limit of</th><th>measured</th><th>allowed</th></tr>\n";
    for (const CompareReport::Limit& l : report.limits)
      html += fmt::format("<tr{}><td>{}</td><td>{:.6g}</td><td>{:.6g}</td></tr>\n", l.pass ? "" : " class=\"broken\"",
                          escape_markup(l.metric), l.measured, l.limit);
    html += "</table>\n";
  }
  html += viewer_html(report.pictures) + "<table><tr><th>metric</th><th>value</th></tr>\n";
  for (const auto& [metric, value] : report.metrics)
    html += fmt::format("<tr><td>{}</td><td>{:.6g}</td></tr>\n", escape_markup(metric), value);
  return html + "</table>\n" + std::string(viewer_script()) + "</body></html>\n";
}

}  // namespace candela
