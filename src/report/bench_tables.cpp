#include "report/bench_tables.h"

#include "report/markup.h"

namespace candela {
namespace {

using Cell = TableCell;
using Row = std::vector<Cell>;

// Four digits that matter, never an exponent: milliseconds are read, not computed with.
std::string milliseconds(double ms) {
  return ms >= 1000  ? fmt::format("{:.0f}", ms)
         : ms >= 100 ? fmt::format("{:.1f}", ms)
         : ms >= 1   ? fmt::format("{:.2f}", ms)
                     : fmt::format("{:.3f}", ms);
}

std::string with_mad(const Series& s) {
  const Summary sum = summary(s.ms);
  return sum.count == 0 ? std::string() : milliseconds(sum.median) + " ± " + milliseconds(sum.mad);
}

std::string runs(const BenchRow& row) {
  return fmt::format("{}{}{}", row.frame.ms.size(), row.runs_capped ? " (cap)" : "", row.budget_hit ? " (time)" : "");
}

// The row of the same picture that others are measured against.
const BenchRow* reference_row(const BenchRow& row, const std::vector<const BenchRow*>& rows) {
  for (const BenchRow* other : rows)
    if (other->lights == row.lights && other->technique == row.picture.reference && other->seed == row.seed)
      return other;
  return nullptr;
}

Cell differing(const BenchRow& row) {
  if (row.picture.reference.empty()) return {row.picture.note.empty() ? "" : "not compared"};
  const std::string against = row.picture.note.empty() ? "" : " (of " + row.picture.reference + ")";
  return {fmt::format("{}{}", row.picture.differing, against),
          row.picture.differing > 0 ? Cell::Kind::bad : Cell::Kind::number};
}

void add_lists(Row& cells, const BenchRow& row) {
  if (!row.lists) {
    cells.resize(cells.size() + 5);
    return;
  }
  const LightLists& lists = *row.lists;
  cells.push_back({fmt::format("{:.1f}", lists.mean)});
  cells.push_back({fmt::format("{:.0f}", lists.p95)});
  cells.push_back({fmt::format("{:.0f}", lists.max)});
  cells.push_back({fmt::format("{:.1f} %", lists.waste_fraction * 100)});
  cells.push_back({fmt::format("{:.0f}", lists.missed), lists.missed > 0 ? Cell::Kind::bad : Cell::Kind::number});
}

std::string range(const PowerFit& fit) {
  return fit.points < 2 ? std::string("too few") : fmt::format("{:.0f} to {:.0f}", fit.first_x, fit.last_x);
}
std::string exponent(const PowerFit& fit) {
  return fit.points < 2 ? std::string() : fmt::format("{:.2f}", fit.exponent);
}

}  // namespace

std::string short_label(const BenchRow& row) {
  const int64_t lights = row.lights_wanted >= 0 ? row.lights_wanted : row.lights;
  return (lights < 0 ? std::string() : fmt::format("{} light{}, ", lights, lights == 1 ? "" : "s")) + row_way(row);
}

std::string summary_table(const std::vector<const BenchRow*>& rows) {
  std::vector<Row> cells;
  for (const BenchRow* row : rows) {
    const BenchRow* reference = reference_row(*row, rows);
    const double ms = summary(row->frame.ms).median;
    Row line = {
        text_cell(row_way(*row)),
        text_cell(row->plan_hash.substr(0, 8)),
        {row->lights < 0 ? "" : fmt::format("{}", row->lights)},
        {with_mad(row->frame)},
        {milliseconds(summary(row->frame.ms).min)},
        {runs(*row)},
        {reference && reference != row && ms > 0 ? fmt::format("{:.2f}", summary(reference->frame.ms).median / ms)
                                                 : ""},
        differing(*row),
        {row->picture.reference.empty() ? "" : fmt::format("{:.3g}", row->picture.max_difference)}};
    add_lists(line, *row);
    cells.push_back(std::move(line));
  }
  return html_table({"technique", "plan", "lights", "frame, ms", "min", "runs", "times faster than reference",
                     "differing pixels", "largest difference", "lights per pixel", "95 %", "most", "waste", "missed"},
                    2, cells);
}

namespace {

// A column for each name that any row has, after those of `first`: of what all rows share, one quantity a table.
std::string series_table(const std::vector<const BenchRow*>& rows, std::vector<Series> BenchRow::*member,
                         Series BenchRow::*sum) {
  std::vector<std::string> head = {"technique", "lights"};
  if (sum) head.emplace_back("sum of passes");
  const size_t first = head.size();
  for (const BenchRow* row : rows)
    for (const Series& s : row->*member)
      if (std::find(head.begin() + long(first), head.end(), s.name) == head.end()) head.push_back(s.name);
  std::vector<Row> cells;
  for (const BenchRow* row : rows) {
    Row line = {text_cell(row_way(*row)), {row->lights < 0 ? "" : fmt::format("{}", row->lights)}};
    if (sum) line.push_back({with_mad(row->*sum)});
    line.resize(head.size());
    for (const Series& s : row->*member) {
      const auto column = std::find(head.begin() + long(first), head.end(), s.name);
      line[size_t(column - head.begin())] = {with_mad(s)};
    }
    cells.push_back(std::move(line));
  }
  return html_table(head, 1, cells);
}

}  // namespace

std::string passes_table(const std::vector<const BenchRow*>& rows) {
  return "<h3>Passes, each timed alone, ms</h3>\n" + series_table(rows, &BenchRow::passes, &BenchRow::gpu) +
         "<h3>CPU stages of a frame, ms</h3>\n" + series_table(rows, &BenchRow::cpu, nullptr);
}

std::string memory_table(const std::vector<const BenchRow*>& rows) {
  std::vector<std::string> head = {"technique", "lights"};
  if (!rows.empty())
    for (const auto& [name, bytes] : rows.front()->memory) {
      std::string words = name.ends_with("_bytes") ? name.substr(0, name.size() - 6) : name;
      std::replace(words.begin(), words.end(), '_', ' ');
      head.push_back(words);
    }
  std::vector<Row> cells;
  for (const BenchRow* row : rows) {
    Row line = {text_cell(row_way(*row)), {row->lights < 0 ? "" : fmt::format("{}", row->lights)}};
    for (const auto& [name, bytes] : row->memory)
      line.push_back({fmt::format("{:.2f}", double(bytes) / double(1 << 20))});
    line.resize(head.size());
    cells.push_back(std::move(line));
  }
  return "<h3>Memory, MiB</h3>\n" + html_table(head, 1, cells);
}

std::string fits_table(const std::vector<Scaling>& all) {
  std::vector<Row> cells;
  for (const Scaling& s : all)
    cells.push_back({text_cell(s.way), {exponent(s.all)}, {range(s.all)}, {exponent(s.top)}, {range(s.top)}});
  return "<p>Exponents of frame time = factor &#215; lights<sup>exponent</sup>, by least squares on logarithms.</p>\n" +
         html_table({"technique", "exponent, all", "lights", "exponent, many lights", "lights"}, 1, cells);
}

std::string remarks_list(const std::vector<const BenchRow*>& rows) {
  std::string html;
  for (const BenchRow* row : rows)
    for (const std::string& remark : row->remarks)
      html += fmt::format("<li>{}: {}</li>\n", escape_markup(short_label(*row)), escape_markup(remark));
  return html.empty() ? html : "<h3>Remarks</h3>\n<ul class=\"note\">\n" + html + "</ul>\n";
}

std::string left_out_list(const BenchRun& run) {
  std::string html;
  for (const BenchRow& row : run.rows) {
    if (!row.left_out.empty())
      html += fmt::format("<li>{}: {}</li>\n", escape_markup(row_title(row)), escape_markup(row.left_out));
    if (!row.error.empty())
      html += fmt::format("<li class=\"error\">{}: {}</li>\n", escape_markup(row_title(row)), escape_markup(row.error));
  }
  return html.empty() ? html : "<section>\n<h2>Not measured</h2>\n<ul>\n" + html + "</ul>\n</section>\n";
}

}  // namespace candela
