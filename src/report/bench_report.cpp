#include "report/bench_report.h"

#include "bench/scaling.h"
#include "report/bench_tables.h"
#include "report/error_report.h"
#include "report/golden_report.h"
#include "report/picture_viewer.h"
#include "report/plot.h"

namespace candela {
namespace {

constexpr std::string_view style =
    "body{font:14px/1.45 sans-serif;margin:2em auto;max-width:1200px;padding:0 1em;background:#fff;color:#222}"
    "h1{font-size:1.6em}h2{font-size:1.2em;margin-top:2.2em;border-bottom:1px solid #ccc;padding-bottom:.2em}"
    "h3{font-size:1em;margin:1.6em 0 .5em}table{border-collapse:collapse;font-size:13px;margin:.5em 0}"
    "th,td{padding:.2em .7em;border-bottom:1px solid #e4e4e4;text-align:right;white-space:nowrap}"
    "th{background:#f4f4f4;font-weight:600;white-space:normal;vertical-align:bottom}td.text,th.text{text-align:left}td."
    "bad{color:#b00020;font-weight:600}"
    ".wide{overflow-x:auto}.note{color:#7a5200}.error{color:#b00020}.faint{color:#777}"
    "figure{display:inline-block;margin:.4em .8em .4em 0;vertical-align:top}figcaption{font-size:12px;color:#555;"
    "max-width:320px}img.picture{image-rendering:auto;max-width:320px}code{font-size:12px}"
    "figure.strip{display:block;max-width:960px}.strip img{width:100%}.strip figcaption{max-width:none}"
    ".thirds{display:flex;font-size:12px;color:#555}.thirds "
    "span{width:33.33%}svg{max-width:none}h2,li{overflow-wrap:anywhere}"
    "summary{cursor:pointer;margin:1em 0}";

// Rows that may share axes, in the order of their first row.
struct Axis {
  std::string name;
  std::vector<const BenchRow*> rows;
};

std::vector<Axis> axes_of(const BenchRun& run) {
  std::vector<Axis> axes;
  for (const BenchRow& row : run.rows) {
    if (row.frame.ms.empty()) continue;
    const std::string name = row_axis(row);
    const auto found = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == name; });
    Axis& axis = found == axes.end() ? axes.emplace_back(Axis{name, {}}) : *found;
    axis.rows.push_back(&row);
  }
  return axes;
}

std::string embedded(std::string_view type, std::string_view text) {
  return fmt::format("data:{};base64,{}", type, base64(std::as_bytes(std::span(text.data(), text.size()))));
}

// An image element of its own: gnuplot's files use the same identifiers in every plot.
std::string plot_html(const Plot& plot, FigureFiles& figures) {
  const auto svg = gnuplot_svg(plot);
  if (svg) figures.add(plot.title, *svg);
  if (!svg) return fmt::format("<p class=\"note\">gnuplot could not draw: {}</p>\n", escape_markup(plot.title));
  return fmt::format("<img src=\"{}\" alt=\"{}\"/>\n", embedded("image/svg+xml", *svg), escape_markup(plot.title));
}

Plot plot_of(const std::vector<Scaling>& all, const std::string& title, const std::string& y_label,
             std::vector<double> Scaling::*y) {
  Plot plot{.title = title, .x_label = "lights", .y_label = y_label};
  for (const Scaling& s : all)
    if (std::any_of((s.*y).begin(), (s.*y).end(), [](double v) { return v > 0; }))
      plot.lines.push_back({s.way, s.lights, s.*y});
  return plot;
}

std::string scaling_html(const std::vector<Scaling>& all, bool plots, FigureFiles& figures) {
  std::string html = "<h3>Time against the number of lights</h3>\n";
  if (plots) {
    html += plot_html(plot_of(all, "Frame time", "ms, median", &Scaling::frame_ms), figures);
    for (const auto& [title, label, member] :
         {std::tuple("Lights in the list of a pixel", "lights, mean", &Scaling::lights_per_pixel),
          std::tuple("Listed lights that contribute nothing", "share", &Scaling::waste_share),
          std::tuple("Memory of the device at its peak", "MiB", &Scaling::memory_mib)}) {
      Plot plot = plot_of(all, title, label, member);
      plot.log_y = member != &Scaling::waste_share;
      if (!plot.lines.empty()) html += plot_html(plot, figures);
    }
  }
  return html + fits_table(all);
}

std::string bars_html(const Axis& axis, FigureFiles& figures) {
  std::vector<Bar> bars;
  for (const BenchRow* row : axis.rows) {
    Bar bar{short_label(*row), {}};
    for (const Series& pass : row->passes) bar.parts.emplace_back(pass.name, summary(pass.ms).median);
    bars.push_back(std::move(bar));
  }
  const std::string times = stacked_bars_svg(bars, "ms"), shares = stacked_shares_svg(bars);
  figures.add("Time of the passes", times), figures.add("Shares of the passes", shares);
  return "<h3>Time of the passes</h3>\n<div class=\"wide\">" + times +
         "</div>\n<h3>The same as shares of each frame</h3>\n<div class=\"wide\">" + shares + "</div>\n";
}

std::string pictures_html(const Axis& axis) {
  std::string html;
  const auto figure = [&](const std::vector<std::byte>& png, const std::string& caption) {
    if (!png.empty())
      html += fmt::format(
          "<figure><img class=\"picture\" src=\"data:image/png;base64,{}\" alt=\"{}\"/><figcaption>{}"
          "</figcaption></figure>\n",
          base64(png), escape_markup(caption), escape_markup(caption));
  };
  // All ways must give one picture: it is shown once for each number of lights.
  std::vector<int64_t> shown;
  for (const BenchRow* row : axis.rows) {
    if (std::find(shown.begin(), shown.end(), row->lights) == shown.end()) {
      shown.push_back(row->lights);
      figure(row->thumbnail, short_label(*row));
    }
    if (row->lists)
      figure(row->heatmap, fmt::format("{}: lights per pixel; yellow is {:.0f} or more, the most are {:.0f}",
                                       short_label(*row), std::max(1.0, row->lists->p95), row->lists->max));
  }
  return html.empty() ? html : "<h3>Pictures</h3>\n" + html;
}

std::string axis_html(const Axis& axis, bool plots, FigureFiles& figures) {
  std::string html = fmt::format("<section>\n<h2>{}</h2>\n", escape_markup(axis.name));
  html += summary_table(axis.rows) + bars_html(axis, figures);
  const std::vector<Scaling> all = scalings(axis.rows);
  if (std::any_of(all.begin(), all.end(), [](const Scaling& s) { return s.lights.size() > 1; }))
    html += scaling_html(all, plots, figures);
  html += passes_table(axis.rows) + memory_table(axis.rows) + remarks_list(axis.rows) + pictures_html(axis);
  return html + "</section>\n";
}

// Folded: what was found stands before what was noted on the way.
std::string notes_html(const std::vector<std::string>& notes) {
  if (notes.empty()) return {};
  std::string html = fmt::format("<details><summary>Notes ({})</summary>\n", notes.size());
  for (const std::string& note : notes) html += fmt::format("<p class=\"note\">{}</p>\n", escape_markup(note));
  return html + "</details>\n";
}

size_t count_devices(const BenchRun& run) {
  std::vector<std::string> devices;
  for (const BenchRow& row : run.rows)
    if (!row.device.empty() && std::find(devices.begin(), devices.end(), row.device) == devices.end())
      devices.push_back(row.device);
  return devices.size();
}

}  // namespace

std::string bench_html(const BenchRun& run, const std::string& title, bool plots, FigureFiles* figures) {
  FigureFiles unwanted;
  FigureFiles& kept = figures ? *figures : unwanted;
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta "
      "charset=\"utf-8\"/><meta name=\"viewport\" "
      "content=\"width=device-width\"/><title>{0}</title>\n<style>{1}</style></head>\n"
      "<body>\n<h1>{0}</h1>\n",
      escape_markup(title), style);
  html += fmt::format(
      "<p>{} configurations in {:.0f} s, {:.0f} s of it opening. Times are medians of interleaved rounds, in "
      "milliseconds, with the median "
      "absolute deviation; <i>frame</i> is the wall time from the scene's pose to bytes in host memory, <i>GPU</i> the "
      "sum of the passes, each timed alone.</p>\n",
      run.rows.size(), run.wall_s, run.opening_s);
  if (!plots)
    html +=
        "<p class=\"note\">gnuplot is not installed: there are no plots against the number of lights, only their "
        "tables.</p>\n";
  if (count_devices(run) > 1)
    html += fmt::format(
        "<p class=\"note\">Rows of {} devices: each has axes of its own, for their times do not belong on "
        "one.</p>\n",
        count_devices(run));
  html += error_html(run, kept);
  for (const Axis& axis : axes_of(run)) html += axis_html(axis, plots, kept);
  return html + left_out_list(run) + notes_html(run.notes) + "</body>\n</html>\n";
}

}  // namespace candela
