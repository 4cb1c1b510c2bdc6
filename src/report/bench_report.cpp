#include "report/bench_report.h"

#include "base/statistics.h"
#include "bench/scaling.h"
#include "report/bench_findings.h"
#include "report/bench_rows.h"
#include "report/bench_tables.h"
#include "report/error_report.h"
#include "report/markup.h"
#include "report/page.h"
#include "report/plot.h"

namespace candela {
namespace {

LinePlot plot_of(const std::vector<Scaling>& all, const std::string& title, const std::string& y_label,
                 std::vector<double> Scaling::*y) {
  LinePlot plot{.title = title, .x_label = "lights", .y_label = y_label};
  for (const Scaling& s : all) {
    if (std::none_of((s.*y).begin(), (s.*y).end(), [](double v) { return v > 0; })) continue;
    auto& line = plot.lines.emplace_back(LinePlot::Line{s.way, {}});
    for (size_t i = 0; i < s.lights.size(); ++i)
      line.points.push_back({s.lights[i], (s.*y)[i], {}, y == &Scaling::frame_ms ? s.frame_ci[i] : Interval{}});
  }
  return plot;
}

std::string scaling_html(const std::vector<Scaling>& all, Figures& figures) {
  const auto add = [&](const LinePlot& plot) {
    return plot.lines.empty() ? std::string() : figures.add(plot.title, plot_script(plot));
  };
  std::string html = "<h3>Time against the number of lights</h3>\n";
  html += add(plot_of(all, "Time of a frame", "ms: median with its 95 % confidence interval", &Scaling::frame_ms));
  html += fits_table(all);
  html +=
      add(plot_of(all, "Lights in the list of a pixel", "lights, mean over the picture", &Scaling::lights_per_pixel));
  LinePlot waste =
      plot_of(all, "Listed lights that contribute nothing", "share of all that are listed", &Scaling::waste_fraction);
  waste.log_y = false;
  html += add(waste);
  return html + add(plot_of(all, "Memory of the device at its peak", "MiB", &Scaling::memory_mib));
}

std::string bars_html(const BenchAxis& axis, Figures& figures) {
  BarPlot plot{.title = "Time of the passes",
               .x_label = "ms of the GPU: sum of the medians of the passes, each timed alone",
               .unit = "ms"};
  const bool one_count = std::all_of(axis.rows.begin(), axis.rows.end(), [&](const BenchRow* row) {
    return row->lights_wanted == axis.rows[0]->lights_wanted && row->lights == axis.rows[0]->lights;
  });
  for (const BenchRow* row : axis.rows) {
    BarPlot::Bar bar{.label = one_count ? row_way(*row) : short_label(*row)};
    for (const Series& pass : row->passes) {
      bar.parts.emplace_back(pass.name, median(pass.ms));
      bar.total += bar.parts.back().second;
    }
    const Interval ci = median_interval(row->gpu.ms);
    if (ci.low <= bar.total && bar.total <= ci.high) bar.ci = ci;
    plot.bars.push_back(std::move(bar));
  }
  const bool log = has_log_axis(plot);
  const std::string caption =
      log ? "The axis is logarithmic; colours divide the length of each bar in proportion to the times of its passes."
          : "";
  std::string html =
      figures.add(plot.title, plot_script(plot),
                  caption + (log ? " " : "") + "Black: 95 % confidence interval of the median of the sum.");
  BarPlot parts = shares(plot);
  parts.title = "Shares of the passes", parts.x_label = "share of the sum of the passes, %";
  html += figures.add(parts.title, plot_script(parts));
  return html.empty() ? html : "<h3>Passes</h3>\n" + html;
}

std::string pictures_html(const BenchAxis& axis) {
  std::string html;
  const auto figure = [&](const std::vector<std::byte>& png, const std::string& caption) {
    if (!png.empty())
      html += fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n", data_url(png),
                          escape_markup(caption), escape_markup(caption));
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
  return html.empty() ? html : "<h3>Pictures</h3>\n<div class=\"pictures\">\n" + html + "</div>\n";
}

std::string axis_html(const BenchAxis& axis, Figures& figures) {
  std::string html =
      fmt::format("<section>\n<h2>{}</h2>\n<p class=\"faint\">{}</p>\n", escape_markup(row_setting(*axis.rows.front())),
                  escape_markup(row_device(*axis.rows.front())));
  const std::vector<Scaling> all = scalings(axis.rows);
  if (std::any_of(all.begin(), all.end(), [](const Scaling& s) { return s.lights.size() > 1; }))
    html += scaling_html(all, figures);
  html += bars_html(axis, figures) + "<h3>Frames</h3>\n" + summary_table(axis.rows) + pictures_html(axis);
  html += folded("Passes, CPU stages and memory", passes_table(axis.rows) + memory_table(axis.rows));
  return html + remarks_list(axis.rows) + "</section>\n";
}

// The times of a sweep of errors stand in its fronts: its frames are folded.
std::string swept_axis_html(const BenchAxis& axis) {
  return folded("Frames, passes and memory: " + row_setting(*axis.rows.front()),
                summary_table(axis.rows) + passes_table(axis.rows) + memory_table(axis.rows) + remarks_list(axis.rows));
}

size_t count_devices(const BenchRun& run) {
  std::vector<std::string> devices;
  for (const BenchRow& row : run.rows)
    if (!row.device.empty() && std::find(devices.begin(), devices.end(), row.device) == devices.end())
      devices.push_back(row.device);
  return devices.size();
}

bool has_errors(const BenchAxis& axis) {
  return std::any_of(axis.rows.begin(), axis.rows.end(), [](const BenchRow* row) { return !row->errors.empty(); });
}

std::string scene_pictures(const BenchRun& run, Figures& figures) {
  std::string html;
  for (const BenchRow* row : rows_of_scene_pictures(run)) {
    const int64_t lights = row->lights_wanted >= 0 ? row->lights_wanted : row->lights;
    html += figures.add_picture(
        row->scene, row->thumbnail,
        row->scene + (lights < 0 ? "" : fmt::format(", {} light{}", lights, lights == 1 ? "" : "s")));
  }
  return html.empty() ? "There is no picture of the scene: these rows were kept without one." : html;
}

PageHead head_of(const BenchRun& run, const std::string& title, Figures& figures) {
  PageHead head{.title = title};
  BenchRun without_errors;
  for (const BenchRow& row : run.rows)
    if (row.errors.empty()) without_errors.rows.push_back(row);
  head.findings = error_findings(run);
  for (PageFinding& finding : bench_findings(without_errors)) head.findings.push_back(std::move(finding));
  std::vector<std::string> scenes, devices, programs;
  for (const BenchRow& row : run.rows) {
    scenes.push_back(fmt::format("{}, {}x{}", row.scene, row.width_px, row.height_px));
    if (row.frame.ms.empty()) continue;
    devices.push_back(row_device(row));
    programs.push_back(program_text(row.version, row.source));
  }
  head.facts = {{"measured", distinct(scenes)},
                {"device", distinct(devices)},
                {"program", distinct(programs)},
                {"run", fmt::format("{} configurations in {:.0f} s, {:.0f} s of it opening", run.rows.size(),
                                    run.wall_s, run.opening_s)},
                {"times",
                 "medians with 95 % confidence intervals; frame: wall time from the scene's pose "
                 "to bytes in host memory; GPU: sum of the passes, each timed alone"}};
  head.picture = scene_pictures(run, figures);
  return head;
}

}  // namespace

std::string bench_html(const BenchRun& run, const std::string& title, Figures& figures) {
  const PageHead head = head_of(run, title, figures);
  std::string html;
  if (!figures.draws()) html += "<p class=\"note\">gnuplot is not installed: there are no figures, only tables.</p>\n";
  if (count_devices(run) > 1)
    html += fmt::format(
        "<p class=\"note\">Rows of {} devices: each has axes of its own, for their times do not belong on "
        "one.</p>\n",
        count_devices(run));
  html += error_html(run, figures);
  std::string swept;
  for (const BenchAxis& axis : axes_of(run))
    if (has_errors(axis))
      swept += swept_axis_html(axis);
    else
      html += axis_html(axis, figures);
  return page_html(head, html + left_out_list(run) + swept + notes_html(run.notes));
}

}  // namespace candela
