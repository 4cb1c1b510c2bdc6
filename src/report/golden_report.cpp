#include "report/golden_report.h"

#include "base/files.h"
#include "report/markup.h"
#include "report/picture_viewer.h"

namespace candela {
namespace {

// Lower comes first on the page.
int urgency(const GoldenRow& row) { return !row.passed ? 0 : row.warned || row.blank ? 1 : 2; }

std::vector<const GoldenRow*> sorted(std::span<const GoldenRow> rows) {
  std::vector<const GoldenRow*> order;
  for (const GoldenRow& row : rows) order.push_back(&row);
  std::stable_sort(order.begin(), order.end(), [](const GoldenRow* a, const GoldenRow* b) {
    return std::pair(urgency(*a), a->name) < std::pair(urgency(*b), b->name);
  });
  return order;
}

std::string figure(const std::filesystem::path& path, std::string_view caption) {
  if (path.empty()) return {};
  const auto bytes = read_file(path);
  const std::string picture = bytes ? fmt::format("<img src=\"{}\" alt=\"{}\">", data_url(*bytes), caption)
                                    : fmt::format("<p class=\"absent\">{}</p>", escape_markup(bytes.error().text()));
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", picture, caption);
}

// All that there are, in a viewer where there are two to compare.
std::string pictures(const GoldenRow& row) {
  if (row.pictures) return viewer_html(*row.pictures);
  return figure(row.golden, "golden") + figure(row.actual, "new") + figure(row.heat_map, "FLIP heat map");
}

// What was measured beside what is allowed.
std::string bounds_table(const GoldenRow& row) {
  if (row.bounds.empty()) return {};
  const auto number = [](double limit) { return std::isfinite(limit) ? fmt::format("{:.4g}", limit) : std::string(); };
  std::string html =
      "<div class=\"wide\"><table><tr><th class=\"text\">measured</th><th>value</th><th>passes at once "
      "to</th><th>warns above</th><th>fails above</th><th class=\"text\">verdict</th></tr>\n";
  for (const GoldenRow::Bound& b : row.bounds)
    html += fmt::format(
        "<tr{}><td class=\"text\">{}</td><td>{:.4g}</td><td>{}</td><td>{}</td><td>{}</td><td "
        "class=\"text\">{}</td></tr>\n",
        b.value > b.fails   ? " class=\"beyond\""
        : b.value > b.warns ? " class=\"above\""
                            : "",
        escape_markup(b.name), b.value, number(b.clean), number(b.warns), number(b.fails),
        b.value > b.fails   ? "fails"
        : b.value > b.warns ? "warns"
                            : "");
  return html + "</table></div>\n";
}

std::string metrics_text(const GoldenRow& row) {
  std::string text;
  for (const auto& [name, value] : row.metrics)
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", name, value);
  return text;
}

std::string section(const GoldenRow& row) {
  static constexpr std::array<std::string_view, 3> classes = {"failed", "warned", "passed"};
  std::string html = fmt::format("<section class=\"{}\">\n<h2>{} <small>{}</small></h2>\n",
                                 classes[size_t(urgency(row))], escape_markup(row.name), escape_markup(row.verdict));
  if (row.blank) html += "<p class=\"blank\">blank frame: every pixel has the same colour</p>\n";
  if (!row.message.empty()) html += fmt::format("<p>{}</p>\n", escape_markup(row.message));
  html += fmt::format("<p class=\"numbers\">{} &middot; {:.2f} s{}{}</p>\n", escape_markup(row.device_class),
                      row.time_s, row.metrics.empty() ? "" : " &middot; ", escape_markup(metrics_text(row)));
  if (urgency(row) < 2) html += bounds_table(row) + pictures(row);
  return html + "</section>\n";
}

size_t count(std::span<const GoldenRow> rows, int wanted) {
  return size_t(std::count_if(rows.begin(), rows.end(), [&](const GoldenRow& row) { return urgency(row) == wanted; }));
}

const std::string golden_style =
    "section{border-left:6px solid #009e73;padding:.2em 0 .2em 1em;margin:1.2em 0}section.failed{border-color:#b00020}"
    "section.warned{border-color:#e69f00}section h2{margin:.2em 0;padding:0;border:0;font-size:1.15em}"
    "small{font-weight:normal}.blank,.absent,.beyond "
    "td{color:#b00020;font-weight:600}.numbers{color:#5c6670;font-size:.9em}"
    ".above td{color:#8a5200;font-weight:600}";

}  // namespace

std::string golden_html(std::span<const GoldenRow> rows, PageHead head) {
  head.findings.push_back(
      {fmt::format("{} failed, {} to look at, {} passed", count(rows, 0), count(rows, 1), count(rows, 2)),
       count(rows, 0) > 0});
  std::string html;
  for (const GoldenRow* row : sorted(rows)) html += section(*row);
  return page_html(head, html, golden_style + viewer_style(), viewer_script());
}

std::string golden_junit(std::span<const GoldenRow> rows, const std::string& suite) {
  double total_s = 0;
  for (const GoldenRow& row : rows) total_s += row.time_s;
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuites>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\" time=\"{:.3f}\">\n",
      escape_markup(suite), rows.size(), count(rows, 0), total_s);
  for (const GoldenRow* row : sorted(rows)) {
    xml += fmt::format("<testcase classname=\"golden.{}\" name=\"{}\" time=\"{:.3f}\">",
                       escape_markup(row->device_class), escape_markup(row->name), row->time_s);
    if (!row->passed)
      xml += fmt::format("<failure message=\"{0}\" type=\"{1}\">{0}\n{2}</failure>", escape_markup(row->message),
                         escape_markup(row->verdict), escape_markup(metrics_text(*row)));
    else
      xml +=
          fmt::format("<system-out>{}{}{}</system-out>", escape_markup(row->verdict), row->blank ? "; blank frame" : "",
                      row->warned ? "; warning: " + escape_markup(row->message) : std::string());
    xml += "</testcase>\n";
  }
  return xml + "</testsuite>\n</testsuites>\n";
}

Expected<void> write_golden_html(const std::filesystem::path& path, std::span<const GoldenRow> rows,
                                 const PageHead& head) {
  return write_file_atomically(path, golden_html(rows, head));
}

Expected<void> write_golden_junit(const std::filesystem::path& path, std::span<const GoldenRow> rows,
                                  const std::string& suite) {
  return write_file_atomically(path, golden_junit(rows, suite));
}

}  // namespace candela
