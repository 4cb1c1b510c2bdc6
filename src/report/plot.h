#pragma once
#include <optional>
#include <string>
#include <vector>

namespace candela {

struct PlotLine {
  std::string name;
  std::vector<double> x, y;
};
struct Plot {
  std::string title, x_label, y_label;
  bool log_x = true, log_y = true;
  std::vector<PlotLine> lines;
};

bool has_gnuplot();
// What gnuplot is told: an SVG on standard output. Names and labels cannot leave their quotes.
std::string gnuplot_script(const Plot& plot, const std::string& terminal = "svg");
// The SVG, or nothing when gnuplot is not there or fails; started without a shell.
std::optional<std::string> gnuplot_svg(const Plot& plot);

// Horizontal bars of stacked parts, drawn here: an SVG element to stand in a page. Parts have one colour in all bars.
struct Bar {
  std::string label;
  std::vector<std::pair<std::string, double>> parts;
};
std::string stacked_bars_svg(const std::vector<Bar>& bars, const std::string& unit);
// The same with every bar scaled to 100.
std::string stacked_shares_svg(std::vector<Bar> bars);
// The figures of a page, to be kept as files of their own beside it: "01-frame-time.svg" and its text, in the page's
// order.
struct FigureFiles {
  std::vector<std::pair<std::string, std::string>> files;
  // Nothing is kept of an empty figure.
  void add(const std::string& title, const std::string& svg);
};

// Of the name'th different part: the same as in stacked_bars_svg.
const char* plot_color(size_t index);

}  // namespace candela
