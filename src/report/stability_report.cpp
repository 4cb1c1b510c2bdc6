#include "report/stability_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/markup.h"
#include "report/page.h"
#include "report/plot.h"

namespace candela {
namespace {

struct Family {
  std::string name;
  std::vector<const StabilityRow*> rows;
  size_t count(auto&& is) const { return size_t(std::count_if(rows.begin(), rows.end(), is)); }
};

bool wrong(const StabilityRow* row) { return !row->faults.empty(); }
bool refused(const StabilityRow* row) { return row->faults.empty() && !row->error.empty(); }
bool right(const StabilityRow* row) { return row->faults.empty() && row->error.empty(); }

std::vector<Family> families_of(const StabilityReport& report) {
  std::vector<Family> families;
  for (const StabilityRow& row : report.rows) {
    auto found = std::find_if(families.begin(), families.end(), [&](const Family& f) { return f.name == row.family; });
    if (found == families.end()) found = families.insert(families.end(), Family{row.family, {}});
    found->rows.push_back(&row);
  }
  return families;
}

size_t scenes_of(const Family& family) {
  std::vector<std::string> names;
  for (const StabilityRow* row : family.rows) names.push_back(row->scene);
  std::sort(names.begin(), names.end());
  return size_t(std::unique(names.begin(), names.end()) - names.begin());
}

std::string families_table(const std::vector<Family>& families) {
  std::vector<std::vector<TableCell>> rows;
  for (const Family& family : families) {
    const StabilityRow* worst = nullptr;  // of those whose pixels all lie within their bound
    uint64_t edges = 0, clamped = 0;
    for (const StabilityRow* row : family.rows) {
      edges += row->beyond, clamped += row->clamped;
      const bool measured = row->beyond == 0 && row->bound > 0 && row->error.empty();
      if (measured && (!worst || row->max_relative / row->bound > worst->max_relative / worst->bound)) worst = row;
    }
    const size_t faulty = family.count(wrong);
    rows.push_back({text_cell(family.name),
                    {fmt::format("{}", scenes_of(family))},
                    {fmt::format("{}", family.rows.size())},
                    {fmt::format("{}", faulty), faulty > 0 ? TableCell::Kind::bad : TableCell::Kind::number},
                    {fmt::format("{}", family.count(refused))},
                    {worst ? fmt::format("{:.2g} of {:g}", worst->max_relative, worst->bound) : ""},
                    text_cell(worst && worst->max_relative > 0 ? worst->scene : ""),
                    {fmt::format("{}", edges)},
                    {fmt::format("{}", clamped)}});
  }
  return html_table({"family", "scenes", "pictures", "wrong", "refused, as they should be",
                     "largest error of its bound", "of", "pixels beyond it at edges", "values beyond half"},
                    1, rows);
}

BarPlot plot_of(const std::vector<Family>& families) {
  BarPlot plot{.title = "Pictures of extreme scenes", .x_label = "pictures: a scene drawn by a technique", .unit = ""};
  plot.may_be_log = false;
  for (const Family& family : families)
    plot.bars.push_back({family.name,
                         double(family.rows.size()),
                         {},
                         {{"as they should be", double(family.count(right))},
                          {"refused, as they should be", double(family.count(refused))},
                          {"wrong", double(family.count(wrong))}}});
  return plot;
}

std::string faults_html(const StabilityReport& report) {
  std::vector<std::string> faults;
  for (const StabilityRow& row : report.rows)
    for (const std::string& fault : row.faults)
      faults.push_back(fmt::format("{}: {}, {}: {}", row.family, row.scene, row.technique, fault));
  return faults.empty() ? "" : "<h2>What is wrong</h2>\n" + list_html(faults, "error");
}

std::string rows_table(const StabilityReport& report) {
  std::vector<std::vector<TableCell>> rows;
  for (const StabilityRow& row : report.rows) {
    const bool drawn = row.error.empty(), measured = drawn && row.truth.find("reference") != std::string::npos;
    rows.push_back({text_cell(row.family),
                    text_cell(row.scene),
                    text_cell(row.what),
                    text_cell(row.technique),
                    text_cell(wrong(&row) ? "wrong"
                              : drawn     ? "right"
                                          : "refused"),
                    {measured ? fmt::format("{:.2g}", row.max_relative) : ""},
                    {measured ? fmt::format("{:g}", row.bound) : ""},
                    {row.truth.find("plain") != std::string::npos ? fmt::format("{:.2g}", row.plain_relative) : ""},
                    {drawn ? fmt::format("{:+.1e}", row.energy) : ""},
                    {drawn ? fmt::format("{}", row.nonfinite) : ""},
                    text_cell(row.truth)});
  }
  return html_table({"family", "scene", "what it is", "technique", "result", "error", "bound", "against plain",
                     "energy", "not finite", "measured against"},
                    5, rows);
}

std::string pictures_html(const std::vector<Family>& families) {
  std::string html;
  for (const Family& family : families) {
    std::string pictures;
    for (const StabilityRow* row : family.rows)
      if (!row->thumbnail.empty())
        pictures += fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                                data_url(row->thumbnail), escape_markup(row->scene + ": " + row->what),
                                escape_markup(row->scene));
    if (!pictures.empty())
      html += "<h3>" + escape_markup(family.name) + "</h3>\n<div class=\"pictures small\">\n" + pictures + "</div>\n";
  }
  return html.empty() ? html : "<h2>The scenes</h2>\n" + html;
}

}  // namespace

std::string stability_html(const StabilityReport& report, const std::string& program, Figures& figures) {
  const std::vector<Family> families = families_of(report);
  PageHead head{.title = "candela bench: stability"};
  head.findings.push_back({fmt::format("{} of {} pictures of {} extreme scenes are wrong", report.faulty_rows,
                                       report.rows.size(), report.scenes),
                           report.faulty_rows > 0});
  head.findings.push_back({fmt::format("{} pixels are not finite", report.nonfinite), report.nonfinite > 0});
  if (report.stopped) head.findings.push_back({"the run was stopped before its end", true});
  head.facts = {{"device", report.device + ", " + report.driver},
                {"program", program},
                {"run", fmt::format("seed {}{}, {:.0f} s", report.seed, report.large ? ", with the large scenes" : "",
                                    report.wall_s)},
                {"truth", "the reference ray tracer in double, or a plain scene that must look the same"}};
  std::string html;
  if (!figures.draws()) html += "<p class=\"note\">gnuplot is not installed: there are no figures, only tables.</p>\n";
  html += faults_html(report) + "<h2>Families</h2>\n";
  const BarPlot plot = plot_of(families);
  html += figures.add(plot.title, plot_script(plot));
  html += families_table(families) + pictures_html(families);
  return page_html(head, html + folded("All pictures", rows_table(report)));
}

}  // namespace candela
