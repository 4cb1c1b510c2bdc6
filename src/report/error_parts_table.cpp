#include "report/error_parts_table.h"

#include <set>

#include "bench/error_truth.h"
#include "report/markup.h"

namespace candela {
namespace {

constexpr std::string_view prefix = "part.";

std::string part_cell(const std::string& text, const char* name = "td", const char* kind = "") {
  return fmt::format("<{0}{1}>{2}</{0}>", name, *kind ? fmt::format(" class=\"{}\"", kind) : "", escape_markup(text));
}

// "all" and "edges" first, then the terms.
std::vector<std::string> parts_of(const ErrorPlace& place) {
  std::set<std::string> names;
  for (const BenchRow* row : place.rows)
    for (const PictureError& error : row->errors)
      for (const auto& [metric, value] : error.metrics)
        if (metric.starts_with(prefix)) names.insert(metric.substr(prefix.size()));
  std::vector<std::string> sorted;
  for (const char* first : {"all", "edges"})
    if (names.erase(first) > 0) sorted.emplace_back(first);
  sorted.insert(sorted.end(), names.begin(), names.end());
  return sorted;
}

}  // namespace

std::string parts_table(const ErrorPlace& place) {
  const std::vector<std::string> parts = parts_of(place);
  if (parts.empty()) return {};
  std::string html = "<div class=\"wide\"><table>\n<tr>";
  for (const char* name : {"against", "technique", "quality"}) html += part_cell(name, "th", "text");
  for (const std::string& part : parts) html += part_cell(part, "th");
  html += "</tr>\n";
  for (const std::string& reference : error_reference_names())
    for (const BenchRow* row : place.rows) {
      const PictureError* error = error_against(*row, reference);
      if (!error || !error->metrics.contains("part.all")) continue;
      html += "<tr>" + part_cell(reference, "td", "text") + part_cell(row->technique, "td", "text") +
              part_cell(row->quality, "td", "text");
      for (const std::string& part : parts) {
        const auto found = error->metrics.find(std::string(prefix) + part);
        html += part_cell(found == error->metrics.end() ? "" : fmt::format("{:.2e}", found->second));
      }
      html += "</tr>\n";
    }
  return html + "</table></div>\n";
}

}  // namespace candela
