#include "report/scatter.h"

#include "report/golden_report.h"
#include "report/plot.h"

namespace candela {
namespace {

constexpr double left = 80, top = 34, width = 720, height = 380;

// A logarithmic axis of whole decades, at least one.
struct Axis {
  int first = 0, last = 1;  // decades
  double length = 0;
  double at(double v) const { return (std::log10(v) - first) / double(last - first) * length; }
};
Axis axis_of(const std::vector<double>& values, double length) {
  Axis axis{.length = length};
  double low = 0, high = 0;
  for (const double v : values)
    if (v > 0) low = low == 0 ? v : std::min(low, v), high = std::max(high, v);
  if (high > 0) axis.first = int(std::floor(std::log10(low))), axis.last = int(std::ceil(std::log10(high)));
  if (axis.last == axis.first) ++axis.last;
  return axis;
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" {}/>\n", x0, y0, x1, y1, style);
}
std::string text(double x, double y, const char* style, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, escape_markup(words));
}

}  // namespace

std::string scatter_svg(const Scatter& scatter) {
  if (scatter.points.empty()) return {};
  std::vector<double> xs, ys;
  for (const ScatterPoint& p : scatter.points) xs.push_back(p.x), ys.push_back(p.y);
  if (scatter.floor_y) ys.push_back(*scatter.floor_y);
  const Axis x_axis = axis_of(xs, width), y_axis = axis_of(ys, height);
  const double bottom = top + height;
  bool zeros = false;
  const auto x_of = [&](double v) { return left + (v > 0 ? x_axis.at(v) : 0); };
  const auto y_of = [&](double v) { return v > 0 ? bottom - y_axis.at(v) : bottom; };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n",
      left + width + 20, bottom + 48 + 18 * std::ceil(double(scatter.groups.size()) / 4));
  svg += text(left, 18, "font-weight=\"600\"", scatter.title);
  for (int d = x_axis.first; d <= x_axis.last; ++d) {
    const double x = x_of(std::pow(10, d));
    svg += line(x, top, x, bottom, "stroke=\"#ddd\"") + text(x, bottom + 16, "text-anchor=\"middle\" fill=\"#666\"", fmt::format("{:g}", std::pow(10, d)));
  }
  for (int d = y_axis.first; d <= y_axis.last; ++d) {
    const double y = y_of(std::pow(10, d));
    svg += line(left, y, left + width, y, "stroke=\"#ddd\"") + text(left - 8, y + 4, "text-anchor=\"end\" fill=\"#666\"", fmt::format("1e{}", d));
  }
  svg += text(left + width / 2, bottom + 34, "text-anchor=\"middle\"", scatter.x_label);
  svg += fmt::format("<text transform=\"translate(18 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n", top + height / 2,
                     escape_markup(scatter.y_label));
  if (scatter.floor_y && *scatter.floor_y > 0) {
    const double y = y_of(*scatter.floor_y);
    svg += line(left, y, left + width, y, "stroke=\"#b00020\" stroke-dasharray=\"6 4\"");
    svg += text(left + width - 4, y - 5, "text-anchor=\"end\" fill=\"#b00020\"", "noise of the reference");
  }
  std::vector<const ScatterPoint*> front;
  for (const ScatterPoint& p : scatter.points)
    if (!p.dimmed) front.push_back(&p);
  std::stable_sort(front.begin(), front.end(), [](const auto* a, const auto* b) { return a->x < b->x; });
  std::string stairs;
  for (size_t i = 0; i < front.size(); ++i)
    stairs += i == 0 ? fmt::format("M{:.1f} {:.1f}", x_of(front[i]->x), y_of(front[i]->y))
                     : fmt::format("H{:.1f}V{:.1f}", x_of(front[i]->x), y_of(front[i]->y));
  svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#444\"/>\n", stairs);
  for (const ScatterPoint& p : scatter.points) {
    zeros = zeros || p.y <= 0;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" opacity=\"{}\"><title>{}: {:.4g}, {:.4g}</title></circle>\n",
                       x_of(p.x), y_of(p.y), p.dimmed ? 4 : 6, plot_color(p.group), p.dimmed ? 0.3 : 1.0, escape_markup(p.label), p.x, p.y);
  }
  for (size_t i = 0; i < front.size(); ++i) {
    const double x = x_of(front[i]->x);
    // Labels of points on one spot would cover each other: the first speaks for them, the pointer shows the rest.
    if (i > 0 && std::abs(x - x_of(front[i - 1]->x)) < 40 && std::abs(y_of(front[i]->y) - y_of(front[i - 1]->y)) < 14) continue;
    const bool far = x > left + width * 0.6;
    // Every second one below its point, so that neighbours keep apart.
    svg += text(x + (far ? -9 : 9), y_of(front[i]->y) + (i % 2 ? 18 : -8), far ? "text-anchor=\"end\" fill=\"#222\" font-size=\"11\"" : "fill=\"#222\" font-size=\"11\"",
                front[i]->label);
  }
  if (zeros) svg += text(left + 4, bottom - 5, "fill=\"#666\" font-size=\"11\"", "on the lower edge: no difference at all");
  for (size_t g = 0; g < scatter.groups.size(); ++g) {
    const double x = left + double(g % 4) * width / 4, y = bottom + 48 + 18 * double(g / 4);
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"/>", x + 5, y - 4, plot_color(g)) + text(x + 15, y, "", scatter.groups[g]);
  }
  return svg + "</svg>\n";
}

}  // namespace candela
