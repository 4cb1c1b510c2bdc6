#include "report/error_tables.h"

#include "base/statistics.h"
#include "bench/error_truth.h"
#include "bench/error_views.h"
#include "report/markup.h"

namespace candela {
namespace {

std::string cell(const std::string& text, const char* kind = "") {
  return fmt::format("<td{}>{}</td>", *kind ? fmt::format(" class=\"{}\"", kind) : "", escape_markup(text));
}
std::string head(const std::vector<std::string>& names, size_t text_columns) {
  std::string html = "<div class=\"wide\"><table>\n<tr>";
  for (size_t i = 0; i < names.size(); ++i)
    html += fmt::format("<th{}>{}</th>", i < text_columns ? " class=\"text\"" : "", escape_markup(names[i]));
  return html + "</tr>\n";
}
std::string number(std::optional<double> value) { return value ? fmt::format("{:.3g}", *value) : ""; }
std::string mebibytes(uint64_t bytes) { return bytes == 0 ? "" : fmt::format("{:.2f}", double(bytes) / (1 << 20)); }
// Nothing where there is no interval, or none that three digits show.
std::string interval_text(double value, const Interval& ci) {
  const std::string low = fmt::format("{:.3g}", ci.low), high = fmt::format("{:.3g}", ci.high);
  const std::string middle = fmt::format("{:.3g}", value);
  return low == middle && high == middle ? "" : fmt::format(" [{}, {}]", low, high);
}
std::string gpu_text(const BenchRow& row, const TimeNoise& noise) {
  return ms_text(median(row.gpu.ms), time_interval(row.gpu.ms, noise));
}

}  // namespace

std::string ms_text(double median, const Interval& ci) {
  if (ci.low == 0 && ci.high == 0) return {};
  return fmt::format("{:.3g}", median) + interval_text(median, ci);
}

std::string totals_table(const ErrorPlace& place) {
  const std::vector<BenchRow> named = rows_by_name(place.rows);
  std::vector<const BenchRow*> rows;
  for (const BenchRow& row : named) rows.push_back(&row);
  std::string html = head(
      {"technique", "quality", "passes, ms [95 % CI]", "images and buffers, MiB", "device peak, MiB", "sampling error",
       "total, unshadowed", "model, unshadowed", "total, direct", "model, direct", "total, path", "model, path"},
      2);
  for (const BenchRow* row : rows) {
    if (row->suite != "whole") continue;
    html += "<tr>" + cell(row->technique, "text") + cell(row->quality, "text") +
            cell(gpu_text(*row, time_noise(place.rows))) + cell(mebibytes(memory_of(*row, "frame_bytes"))) +
            cell(mebibytes(memory_of(*row, "device_peak_bytes"))) +
            cell(number(error_of(*row, exact_reference, "relmse")));
    for (const char* reference : {open_reference_name, "direct", "path"}) {
      const auto totals = total_errors(rows, reference);
      const auto own = std::find_if(totals.begin(), totals.end(), [&](const TotalError& t) { return t.row == row; });
      html += own == totals.end() ? "<td></td><td></td>" : cell(number(own->total)) + cell(number(own->model));
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string knob_table(const std::vector<KnobStudy>& studies) {
  std::string html =
      head({"knob", "technique", "trades", "value", "worth its time?", "frame's passes, GPU ms [95 % CI]",
            "its own passes, GPU ms [95 % CI]", "images and buffers, MiB", "relmse", "rmse"},
           5);
  for (const KnobStudy& study : studies)
    for (const KnobStudy::Value& v : study.values)
      html += "<tr>" + cell(study.knob, "text") + cell(study.technique, "text") + cell(study.kind, "text") +
              cell(v.text + (v.text == study.advised ? " (advised)" : ""), "text") +
              cell(v.verdict, v.dominated ? "text faint" : "text") + cell(ms_text(v.ms, v.ms_ci)) +
              cell(ms_text(v.passes_ms, v.passes_ci)) + cell(mebibytes(memory_of(*v.row, "frame_bytes"))) +
              cell(number(v.relmse) + interval_text(v.relmse, v.relmse_ci),
                   study.kind == "time" && v.rmse > 0 ? "bad" : "") +
              cell(number(v.rmse)) + "</tr>\n";
  return html + "</table></div>\n";
}

std::string error_rows_table(const ErrorPlace& place) {
  static constexpr const char* metrics[] = {"relmse", "relmse-trimmed", "rmse",     "mae",  "max",      "p99",
                                            "psnr",   "flip",           "hdr-flip", "ssim", "differing"};
  std::vector<std::string> names = {"setting", "sweep", "against", "passes, ms [95 % CI]", "MiB"};
  names.insert(names.end(), std::begin(metrics), std::end(metrics));
  names.emplace_back("noise (relmse)");
  std::string html = head(names, 3);
  for (const BenchRow* row : place.rows) {
    const std::string gpu = gpu_text(*row, time_noise(place.rows));
    for (const PictureError& error : row->errors) {
      html += "<tr>" + cell(error_names(*row), "text") + cell(row->suite, "text") + cell(error.reference, "text") +
              cell(gpu) + cell(mebibytes(memory_of(*row, "frame_bytes")));
      for (const char* metric : metrics) {
        const bool noise = std::string_view(metric) == "relmse" && error.noise &&
                           error_of(*row, error.reference, metric).value_or(1e300) <= error.noise->relmse;
        const auto value = error_of(*row, error.reference, metric);
        html += cell(
            number(value) +
                (value && std::string_view(metric) == "relmse" ? interval_text(*value, error_interval(error, metric))
                                                               : "") +
                (noise ? " (below noise)" : ""),
            noise ? "faint" : "");
      }
      html += cell(error.noise ? fmt::format("{:.3g}", error.noise->relmse) : "") + "</tr>\n";
    }
  }
  return html + "</table></div>\n";
}

}  // namespace candela
