#pragma once
#include <optional>
#include <string>
#include <vector>

namespace candela {

struct ScatterPoint {
  std::string label;  // shown by the pointer; those of the front are written beside it too
  double x = 0, y = 0;
  size_t group = 0;              // colour
  bool dimmed = false;           // dominated
  double low_x = 0, high_x = 0;  // ends of an error bar; equal: none
  double low_y = 0, high_y = 0;  // the same
  bool ring = false;             // not distinguishable from a point of the front
};
// Points on logarithmic axes that end at 1, 2 or 5 of a decade, with the front as a staircase and the noise floor as a
// line; drawn here, without gnuplot. Points whose y is 0 stand on the lower edge, which is said.
struct Scatter {
  std::string title, x_label, y_label;
  std::vector<ScatterPoint> points;
  std::vector<std::string> groups;  // names for the legend
  std::optional<double> floor_y;
  bool stairs = true;                            // joins what is neither dimmed nor a ring as a front
  std::vector<std::pair<double, double>> curve;  // dashed: a law that was fitted
};
std::string scatter_svg(const Scatter& scatter);  // an SVG element to stand in a page; empty without points

}  // namespace candela
