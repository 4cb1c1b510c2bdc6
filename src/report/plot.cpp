#include "report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/plot_canvas.h"

namespace candela {
namespace {

using Rows = std::vector<std::vector<double>>;

bool has_bar(const Interval& ci) { return ci.low < ci.high; }

std::string plot_style(const char* with, const std::string& color, int shape, double size, double line_width = 1.5) {
  return fmt::format("with {} pt {} ps {} lw {} lc rgb '{}'", with, shape, size, line_width, color);
}

// From the low to the high end: rows of x, y, low, high; with caps.
std::string x_bars_style(const std::string& color) {
  return fmt::format("3:2:($4-$3):(0) with vectors heads size graph 0.006,90 lw 1.5 lc rgb '{}'", color);
}
std::string y_bars_style(const std::string& color) {
  return fmt::format("1:3:(0):($4-$3) with vectors heads size graph 0.006,90 lw 1.5 lc rgb '{}'", color);
}

double total_of(const std::vector<std::pair<std::string, double>>& parts) {
  double sum = 0;
  for (const auto& part : parts) sum += part.second;
  return sum;
}

struct PlotBox {
  double x0, y0, x1, y1;
  bool meets(const PlotBox& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

// The number of each point of the front, beside it where nothing else is. places: of the front's points, first; then of
// others that must not be covered. Points on one spot have one text, "3–5".
void number_points(PlotCanvas& canvas, size_t count, const Rows& places) {
  std::vector<PlotBox> taken;
  for (const auto& place : places) taken.push_back({place[0] - 8, place[1] - 8, place[0] + 8, place[1] + 8});
  const auto on_one_spot = [&](size_t a, size_t b) {
    return std::abs(places[a][0] - places[b][0]) < 12 && std::abs(places[a][1] - places[b][1]) < 12;
  };
  for (size_t i = 0, end = 0; i < count; i = end) {
    for (end = i + 1; end < count && on_one_spot(i, end);) ++end;
    const std::string text = end - i > 1 ? fmt::format("{}–{}", i + 1, end) : fmt::format("{}", i + 1);
    const double half_wide = PlotCanvas::letter * double(letters_of(text)) / 2 + 1, half_high = 9;
    const double x = places[i][0], y = places[i][1];
    constexpr double around[][2] = {{1, -1}, {1, 1}, {-1, -1}, {-1, 1}, {0, -1.2}, {0, 1.2}, {1.2, 0}, {-1.2, 0}};
    bool placed = false;
    for (double away = 15; away < 100 && !placed; away += 10)
      for (const auto& [dx, dy] : around) {
        const double u = x + dx * (away + half_wide - 6), v = y + dy * away;
        const PlotBox box{u - half_wide, v - half_high, u + half_wide, v + half_high};
        if (box.x0 < canvas.left() + 2 || box.x1 > canvas.right() || box.y0 < canvas.top() - 8 ||
            box.y1 > canvas.bottom() - 2 ||
            std::any_of(taken.begin(), taken.end(), [&](const PlotBox& other) { return other.meets(box); }))
          continue;
        canvas.text(u, v, text, "center", ",15");
        taken.push_back(box);
        placed = true;
        break;
      }
  }
}

std::vector<const ScatterPlot::Point*> front_of(const ScatterPlot& plot) {
  std::vector<const ScatterPlot::Point*> front;
  for (const auto& p : plot.points)
    if (!p.dimmed && !p.ring) front.push_back(&p);
  std::stable_sort(front.begin(), front.end(), [](const auto* a, const auto* b) { return a->at.x < b->at.x; });
  return front;
}

// Whether the floor lies among what was measured, or just below.
bool shows_floor(const ScatterPlot& plot) {
  if (!plot.floor_y || !(*plot.floor_y > 0)) return false;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& p : plot.points)
    if (p.at.y > 0) least = std::min(least, p.at.y);
  return *plot.floor_y > least / 5;
}

std::pair<PlotAxis, PlotAxis> axes_of(const ScatterPlot& plot) {
  std::vector<double> xs, ys;
  bool zeros = false;
  for (const auto& [label, at, group, dimmed, ring] : plot.points) {
    xs.push_back(at.x), ys.push_back(at.y);
    zeros = zeros || at.y <= 0;
    if (has_bar(at.x_ci)) xs.push_back(at.x_ci.low), xs.push_back(at.x_ci.high);
    // A bar that reaches near 0 ends at the lower edge; the axis does not follow it there.
    if (has_bar(at.y_ci)) ys.push_back(std::max(at.y_ci.low, at.y / 5)), ys.push_back(at.y_ci.high);
  }
  // A floor far below what was measured must not squeeze it.
  if (shows_floor(plot)) ys.push_back(*plot.floor_y);
  return {log_axis(xs), log_axis(ys, zeros)};
}

// All points of a group that stand alike, with their error bars.
void draw_points(PlotCanvas& canvas, const ScatterPlot& plot, size_t group, bool dimmed, bool ring, double low_y) {
  Rows points, x_bars, y_bars;
  for (const auto& p : plot.points) {
    if (p.group != group || p.dimmed != dimmed || (!dimmed && p.ring != ring)) continue;
    const double y = std::max(p.at.y, low_y);
    points.push_back({p.at.x, y});
    if (has_bar(p.at.x_ci)) x_bars.push_back({p.at.x, y, p.at.x_ci.low, p.at.x_ci.high});
    if (has_bar(p.at.y_ci)) y_bars.push_back({p.at.x, y, std::max(p.at.y_ci.low, low_y), p.at.y_ci.high});
  }
  const std::string color = plot_color(group, dimmed);
  canvas.data(x_bars, x_bars_style(color));
  canvas.data(y_bars, y_bars_style(color));
  canvas.data(points, "1:2 " + plot_style("points", color, plot_shape(group, ring && !dimmed), dimmed ? 0.7 : 1.1, 2));
}

}  // namespace

std::string plot_script(const LinePlot& plot) {
  PlotCanvas canvas(plot.title, plot.y_label, 92, 400);
  std::vector<double> xs, ys;
  std::vector<Rows> drawn;
  for (const auto& line : plot.lines) {
    Rows& rows = drawn.emplace_back();
    for (const auto& [x, y, x_ci, y_ci] : line.points) {
      if (!std::isfinite(y) || !(x > 0) || (plot.log_y && !(y > 0))) continue;
      const bool bar = has_bar(y_ci) && (y_ci.low > 0 || !plot.log_y);
      rows.push_back({x, y, bar ? y_ci.low : y, bar ? y_ci.high : y});
      xs.push_back(x);
      ys.insert(ys.end(), {y, rows.back()[2], rows.back()[3]});
    }
  }
  if (xs.empty()) return {};
  const PlotAxis y_axis = plot.log_y ? log_axis(ys) : linear_axis(*std::max_element(ys.begin(), ys.end()));
  canvas.axes(count_axis(xs), y_axis, plot.x_label);
  std::vector<KeyEntry> key;
  for (size_t i = 0; i < drawn.size(); ++i) {
    if (drawn[i].empty()) continue;
    const std::string color = plot_color(i);
    Rows bars;
    for (const auto& row : drawn[i])
      if (row[2] < row[3]) bars.push_back(row);
    canvas.data(bars, y_bars_style(color));
    canvas.data(drawn[i], "1:2 " + plot_style("linespoints", color, plot_shape(i), 0.9, 2.5));
    key.push_back({plot.lines[i].name, color, plot_shape(i)});
  }
  canvas.key(key);
  return canvas.script();
}

std::string plot_script(const ScatterPlot& plot) {
  if (plot.points.empty()) return {};
  const auto [x_axis, y_axis] = axes_of(plot);
  PlotCanvas canvas(plot.title, plot.y_label, 92, 400);
  canvas.axes(x_axis, y_axis, plot.x_label);
  const auto front = front_of(plot);
  std::vector<KeyEntry> key;
  if (plot.stairs) {
    Rows stairs;
    for (const auto* p : front) stairs.push_back({p->at.x, std::max(p->at.y, y_axis.low)});
    canvas.data(stairs, "1:2 with steps lw 1.5 lc rgb '#777777'");
  }
  if (plot.floor_y && *plot.floor_y > 0 && !shows_floor(plot)) {
    key.push_back(
        {fmt::format("noise of the reference: {:.1g}, below what is shown", *plot.floor_y), "#b00020", 0, true});
  } else if (shows_floor(plot)) {
    canvas.data({{x_axis.low, *plot.floor_y}, {x_axis.high, *plot.floor_y}},
                "1:2 with lines lw 1.5 dt 2 lc rgb '#b00020'");
    key.push_back({"noise of the reference", "#b00020", 0, true});
  }
  Rows curve;
  for (const auto& [x, y] : plot.curve) curve.push_back({x, y});
  canvas.data(curve, "1:2 with lines lw 1.5 dt 3 lc rgb '#555555'");
  if (!curve.empty()) key.push_back({"law that was fitted", "#555555", 0, true});
  bool rings = false, dims = false;
  for (const auto& [dimmed, ring] : {std::pair(true, false), {false, true}, {false, false}})
    for (size_t group = 0; group < plot.groups.size(); ++group)
      draw_points(canvas, plot, group, dimmed, ring, y_axis.low);
  for (const auto& p : plot.points) rings = rings || (p.ring && !p.dimmed), dims = dims || p.dimmed;
  for (size_t group = 0; group < plot.groups.size(); ++group)
    key.push_back({plot.groups[group], plot_color(group), plot_shape(group)});
  if (rings) key.push_back({"not distinguishable from the front", "#777777", plot_shape(0, true)});
  if (dims) key.push_back({"dominated", "#c8c8c8", plot_shape(0)});
  canvas.key(key);
  if (!plot.stairs) return canvas.script();
  constexpr size_t most_numbers = 16;
  const size_t count = std::min(front.size(), most_numbers);
  Rows places;
  std::vector<std::string> names;
  const auto add_place = [&](const ScatterPlot::Point& p) {
    places.push_back({canvas.x_of(p.at.x), canvas.y_of(std::max(p.at.y, y_axis.low))});
  };
  for (size_t i = 0; i < count; ++i) {
    add_place(*front[i]);
    names.push_back(fmt::format("{}   {}", i + 1, front[i]->label));
  }
  if (front.size() > count) names.push_back(fmt::format("and {} more of the front", front.size() - count));
  for (const auto& p : plot.points)
    if (!p.dimmed) add_place(p);
  number_points(canvas, count, places);
  canvas.lines(names);
  return canvas.script();
}

bool has_log_axis(const BarPlot& plot) {
  double least = INFINITY, most = 0;
  for (const auto& bar : plot.bars)
    if (bar.total > 0) least = std::min(least, bar.total), most = std::max(most, bar.total);
  return plot.may_be_log && most > 5 * least;
}

BarPlot shares(BarPlot plot) {
  for (auto& bar : plot.bars) bar.total = 100, bar.ci = {};
  plot.unit = "%";
  return plot;
}

namespace {

// Parts by the largest fraction that they have of any bar, as many as there are colours; the rest is one.
std::vector<std::string> main_parts(const BarPlot& plot) {
  std::vector<std::pair<std::string, double>> shares;
  for (const auto& bar : plot.bars) {
    const double sum = total_of(bar.parts);
    for (const auto& [name, value] : bar.parts) {
      auto found = std::find_if(shares.begin(), shares.end(), [&](const auto& s) { return s.first == name; });
      if (found == shares.end()) found = shares.insert(shares.end(), {name, 0.0});
      if (sum > 0) found->second = std::max(found->second, value / sum);
    }
  }
  std::vector<std::string> order, names;
  for (const auto& [name, fraction] : shares) order.push_back(name);
  if (shares.size() > plot_colors) {
    std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    shares.resize(plot_colors);
  }
  for (const std::string& name : order)
    if (std::any_of(shares.begin(), shares.end(), [&](const auto& s) { return s.first == name; }))
      names.push_back(name);
  return names;
}

// Cumulative shares of a bar along the names, with the others last; all of one colour without parts.
std::vector<double> ends_of(const BarPlot::Bar& bar, const std::vector<std::string>& names) {
  std::vector<double> ends(names.size() + 2, 0.0);
  const double sum = total_of(bar.parts);
  for (const auto& [name, value] : bar.parts) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (sum > 0) ends[size_t(found - names.begin()) + 1] += value / sum;
  }
  if (!(sum > 0)) ends[1] = 1;
  for (size_t i = 1; i < ends.size(); ++i) ends[i] += ends[i - 1];
  return ends;
}

std::string value_text(double value, const std::string& unit) {
  const std::string number = value >= 1000 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace

std::string plot_script(const BarPlot& plot) {
  std::vector<double> totals;
  size_t letters = 4;
  constexpr size_t most_letters = 52;
  for (const auto& bar : plot.bars)
    if (bar.total > 0) {
      totals.push_back(bar.total);
      if (has_bar(bar.ci)) totals.push_back(bar.ci.high);
      letters = std::max(letters, letters_of(shortened(bar.label, most_letters)));
    }
  if (totals.empty()) return {};
  const bool log = has_log_axis(plot), percent = plot.unit == "%";
  // Room for the value behind the longest bar.
  PlotAxis x = log ? log_axis(totals) : linear_axis(*std::max_element(totals.begin(), totals.end()));
  if (log && *std::min_element(totals.begin(), totals.end()) < x.low * 2)
    x = log_axis([&] {
      totals.push_back(x.low / 2);
      return totals;
    }());
  const double room = percent ? 1 : log ? std::pow(x.high / x.low, 0.14) : 1.14;
  x.high *= room;
  constexpr double row = 26;
  const double count = double(plot.bars.size());
  PlotCanvas canvas(plot.title, "", 24 + PlotCanvas::letter * double(letters), row * count + 8);
  canvas.axes(x, {.low = 0, .high = count, .log = false, .ticks = {}}, plot.x_label);
  const std::vector<std::string> names = main_parts(plot);
  std::vector<Rows> boxes(names.size() + 1);
  Rows whiskers;
  for (size_t b = 0; b < plot.bars.size(); ++b) {
    const BarPlot::Bar& bar = plot.bars[b];
    const double y = count - double(b) - 0.5;
    canvas.text(canvas.left() - 10, canvas.y_of(y), shortened(bar.label, most_letters), "right");
    if (!(bar.total > 0)) continue;
    const std::vector<double> ends = ends_of(bar, names);
    const auto along = [&](double fraction) {
      return log ? x.low * std::pow(bar.total / x.low, fraction) : bar.total * fraction;
    };
    for (size_t i = 0; i < boxes.size(); ++i)
      if (ends[i + 1] > ends[i])
        boxes[i].push_back({along(ends[i]), y, along(ends[i]), along(ends[i + 1]), y - 0.38, y + 0.38});
    if (has_bar(bar.ci)) whiskers.push_back({bar.total, y, std::max(bar.ci.low, x.low), bar.ci.high});
    if (!percent)
      canvas.text(canvas.x_of(std::max(bar.total, bar.ci.high)) + 8, canvas.y_of(y), value_text(bar.total, plot.unit),
                  "left", "", "#444444");
  }
  std::vector<KeyEntry> key;
  for (size_t i = 0; i < boxes.size(); ++i) {
    const std::string color = i < names.size() ? plot_color(i) : names.empty() ? plot_color(0) : others_color;
    canvas.data(boxes[i], fmt::format("1:2:3:4:5:6 with boxxyerror fill solid 1 noborder lc rgb '{}'", color));
    if (!boxes[i].empty() && !names.empty()) key.push_back({i < names.size() ? names[i] : "others", color, 5});
  }
  canvas.data(whiskers, x_bars_style("#111111"));
  canvas.key(key);
  return canvas.script();
}

}  // namespace candela
