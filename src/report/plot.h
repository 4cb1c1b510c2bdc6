#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/statistics.h"

// The figures of reports as scripts of gnuplot: lines, points and bars of one style, 960 units wide. Functions return
// nothing where there is nothing to draw. Names and labels cannot leave their quotes, and are shortened where they are
// too long.
namespace candela {

struct PlotPoint {
  double x = 0, y = 0;
  Interval x_ci, y_ci;  // error bars; none where the ends are equal
};

// Lines over a logarithmic axis of counts. Values without a logarithm are left out.
struct LinePlot {
  std::string title, x_label, y_label;
  bool log_y = true;  // else from 0
  struct Line {
    std::string name;
    std::vector<PlotPoint> points;
  };
  std::vector<Line> lines;
};

// Points on logarithmic axes, with the front as a staircase; those of the front are numbered, and their labels stand
// below. Points whose y is 0 stand on the lower edge, which is marked 0.
struct ScatterPlot {
  std::string title, x_label, y_label;
  struct Point {
    std::string label;
    PlotPoint at;
    size_t group = 0;     // colour and shape
    bool dimmed = false;  // dominated
    bool ring = false;    // not distinguishable from a point of the front
  };
  std::vector<Point> points;
  std::vector<std::string> groups;  // names for the key
  std::optional<double> floor_y = {};
  bool stairs = true;                                 // joins what is neither dimmed nor a ring as a front
  std::vector<std::pair<double, double>> curve = {};  // dashed: a law that was fitted
};

// Horizontal bars. On a logarithmic axis (totals further apart than a factor of 5) the parts divide a bar's length in
// proportion; else they are stacked on one axis from 0. Beyond seven parts the smaller ones are one, "others".
struct BarPlot {
  std::string title, x_label, unit;
  struct Bar {
    std::string label;
    double total = 0;
    Interval ci;                                        // an error bar at the end; none where the ends are equal
    std::vector<std::pair<std::string, double>> parts;  // of any scale; the bar is of one colour without them
  };
  std::vector<Bar> bars;
  bool may_be_log = true;
};
bool has_log_axis(const BarPlot& plot);
// Every bar scaled to 100 %.
BarPlot shares(BarPlot plot);

std::string plot_script(const LinePlot& plot);
std::string plot_script(const ScatterPlot& plot);
std::string plot_script(const BarPlot& plot);

}  // namespace candela
