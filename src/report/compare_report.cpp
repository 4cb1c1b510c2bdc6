#include "report/compare_report.h"

#include "report/markup.h"
#include "report/page.h"

namespace candela {

std::string compare_html(const CompareReport& report) {
  PageHead head{.title = "candela compare: " + report.test + " against " + report.reference};
  head.facts = {{"reference", report.reference}, {"test", report.test}, {"program", report.program}};
  std::vector<std::vector<TableCell>> limits, metrics;
  for (const CompareReport::Limit& l : report.limits) {
    const auto kind = l.pass ? TableCell::Kind::number : TableCell::Kind::bad;
    limits.push_back(
        {text_cell(l.metric), {fmt::format("{:.6g}", l.measured), kind}, {fmt::format("{:.6g}", l.limit), kind}});
    head.findings.push_back({fmt::format("{} is {:.4g}: {} its limit of {:.4g}", l.metric, l.measured,
                                         l.pass ? "within" : "beyond", l.limit),
                             !l.pass});
  }
  for (const auto& [metric, value] : report.metrics)
    metrics.push_back({text_cell(metric), {fmt::format("{:.6g}", value)}});
  if (head.findings.empty())
    for (const char* metric : {"flip", "differing"})
      if (const auto found = report.metrics.find(metric); found != report.metrics.end())
        head.findings.push_back({fmt::format("{}: {:.4g}", metric, found->second)});
  std::string html = viewer_html(report.pictures);
  if (!limits.empty()) html += html_table({"limit of", "measured", "allowed"}, 1, limits);
  return page_html(head, html + html_table({"metric", "value"}, 1, metrics), viewer_style(), viewer_script());
}

}  // namespace candela
