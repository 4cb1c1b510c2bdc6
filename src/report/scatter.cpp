#include "report/scatter.h"

#include "report/golden_report.h"
#include "report/plot.h"

namespace candela {
namespace {

constexpr double left = 80, top = 34, width = 720, height = 380;

// The largest value 1, 2 or 5 of a decade that is at most v, or the smallest that is at least v.
double step_below(double v) {
  const double decade = std::pow(10, std::floor(std::log10(v) + 1e-9));
  for (const double step : {5.0, 2.0})
    if (v >= step * decade * (1 - 1e-9)) return step * decade;
  return decade;
}
double step_above(double v) {
  const double below = step_below(v);
  if (v <= below * (1 + 1e-9)) return below;
  const double lead = below / std::pow(10, std::floor(std::log10(below) + 1e-9));
  return below * (lead < 1.5 || lead > 4 ? 2 : 2.5);
}

// A logarithmic axis, of half a decade at least.
struct Axis {
  double first = 1, last = 10, length = 0;
  double at(double v) const {
    return std::log10(std::clamp(v, first, last) / first) / std::log10(last / first) * length;
  }
  // Where lines and numbers stand: decades, and 2 and 5 of them where there is room.
  std::vector<double> ticks() const {
    std::vector<double> all;
    const bool few = last / first < 1.01e3;
    for (double tick = first; tick < last * 1.001; tick = step_above(tick * 1.01)) {
      const double decade = std::log10(tick);
      if (few || std::abs(decade - std::round(decade)) < 1e-6) all.push_back(tick);
    }
    return all;
  }
};
Axis axis_of(const std::vector<double>& values, double length) {
  Axis axis{.length = length};
  double low = 0, high = 0;
  for (const double v : values)
    if (v > 0) low = low == 0 ? v : std::min(low, v), high = std::max(high, v);
  if (high > 0) axis.first = step_below(low), axis.last = step_above(high);
  while (axis.last / axis.first < 4.9) axis.last = step_above(axis.last * 1.01);
  return axis;
}
std::string tick_text(double v) { return v >= 0.001 && v < 1e5 ? fmt::format("{:.4g}", v) : fmt::format("{:.0e}", v); }

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
  for (const ScatterPoint& p : scatter.points) {
    xs.push_back(p.x), ys.push_back(p.y);
    if (p.low_x < p.high_x) xs.push_back(p.low_x), xs.push_back(p.high_x);
    // A bar that reaches near 0 ends at the lower edge; the axis does not follow it there.
    if (p.low_y < p.high_y) ys.push_back(std::max(p.low_y, p.y / 5)), ys.push_back(p.high_y);
  }
  if (scatter.floor_y) ys.push_back(*scatter.floor_y);
  const Axis x_axis = axis_of(xs, width), y_axis = axis_of(ys, height);
  const double bottom = top + height;
  bool zeros = false;
  const auto x_of = [&](double v) { return left + (v > 0 ? x_axis.at(v) : 0); };
  const auto y_of = [&](double v) { return v > 0 ? bottom - y_axis.at(v) : bottom; };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n",
      left + width + 20, bottom + 58 + 18 * std::ceil(double(scatter.groups.size()) / 4));
  svg += text(left, 18, "font-weight=\"600\"", scatter.title);
  for (const double tick : x_axis.ticks())
    svg += line(x_of(tick), top, x_of(tick), bottom, "stroke=\"#ddd\"") +
           text(x_of(tick), bottom + 16, "text-anchor=\"middle\" fill=\"#666\"", tick_text(tick));
  for (const double tick : y_axis.ticks())
    svg += line(left, y_of(tick), left + width, y_of(tick), "stroke=\"#ddd\"") +
           text(left - 8, y_of(tick) + 4, "text-anchor=\"end\" fill=\"#666\"", tick_text(tick));
  svg += text(left + width / 2, bottom + 34, "text-anchor=\"middle\"", scatter.x_label);
  svg += fmt::format("<text transform=\"translate(18 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     top + height / 2, escape_markup(scatter.y_label));
  if (scatter.floor_y && *scatter.floor_y > 0) {
    const double y = y_of(*scatter.floor_y);
    svg += line(left, y, left + width, y, "stroke=\"#b00020\" stroke-dasharray=\"6 4\"");
    svg += text(left + width - 4, y - 5, "text-anchor=\"end\" fill=\"#b00020\"", "noise of the reference");
  }
  for (size_t i = 1; i < scatter.curve.size(); ++i)
    svg += line(x_of(scatter.curve[i - 1].first), y_of(scatter.curve[i - 1].second), x_of(scatter.curve[i].first),
                y_of(scatter.curve[i].second), "stroke=\"#444\" stroke-dasharray=\"3 3\"");
  std::vector<const ScatterPoint*> front;
  for (const ScatterPoint& p : scatter.points)
    if (!p.dimmed && !p.ring) front.push_back(&p);
  std::stable_sort(front.begin(), front.end(), [](const auto* a, const auto* b) { return a->x < b->x; });
  std::string stairs;
  for (size_t i = 0; i < front.size() && scatter.stairs; ++i)
    stairs += i == 0 ? fmt::format("M{:.1f} {:.1f}", x_of(front[i]->x), y_of(front[i]->y))
                     : fmt::format("H{:.1f}V{:.1f}", x_of(front[i]->x), y_of(front[i]->y));
  if (!stairs.empty()) svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#444\"/>\n", stairs);
  for (const ScatterPoint& p : scatter.points) {
    zeros = zeros || p.y <= 0;
    if (p.low_x < p.high_x)
      svg += fmt::format(
          "<path d=\"M{0:.1f} {2:.1f}V{3:.1f}M{0:.1f} {4:.1f}H{1:.1f}M{1:.1f} {2:.1f}V{3:.1f}\" fill=\"none\" "
          "stroke=\"{5}\" opacity=\"{6}\"/>\n",
          x_of(p.low_x), x_of(p.high_x), y_of(p.y) - 4, y_of(p.y) + 4, y_of(p.y), plot_color(p.group),
          p.dimmed ? 0.3 : 1.0);
    if (p.low_y < p.high_y)
      svg += fmt::format(
          "<path d=\"M{1:.1f} {3:.1f}H{2:.1f}M{0:.1f} {3:.1f}V{4:.1f}M{1:.1f} {4:.1f}H{2:.1f}\" fill=\"none\" "
          "stroke=\"{5}\" opacity=\"{6}\"/>\n",
          x_of(p.x), x_of(p.x) - 4, x_of(p.x) + 4, y_of(std::max(p.low_y, 0.0)), y_of(p.high_y), plot_color(p.group),
          p.dimmed ? 0.3 : 1.0);
    const std::string color = plot_color(p.group);
    const std::string paint =
        p.ring ? "fill=\"#fff\" stroke=\"" + color + "\" stroke-width=\"2\"" : "fill=\"" + color + "\"";
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" {} opacity=\"{}\"><title>{}: {:.4g}, "
        "{:.4g}</title></circle>\n",
        x_of(p.x), y_of(p.y),
        p.dimmed ? 4
        : p.ring ? 5
                 : 6,
        paint, p.dimmed ? 0.3 : 1.0, escape_markup(p.label), p.x, p.y);
  }
  for (size_t i = 0; i < front.size(); ++i) {
    const double x = x_of(front[i]->x);
    // Labels of points on one spot would cover each other: the first speaks for them, the pointer shows the rest.
    if (i > 0 && std::abs(x - x_of(front[i - 1]->x)) < 40 &&
        (std::abs(y_of(front[i]->y) - y_of(front[i - 1]->y)) < 14 || front[i]->label == front[i - 1]->label))
      continue;
    const bool far = x > left + width * 0.6;
    // Every second one below its point, so that neighbours keep apart.
    const bool above = i % 2 == 0 || y_of(front[i]->y) > bottom - 24;  // the axis has numbers below it
    svg += text(x + (far ? -9 : 9), y_of(front[i]->y) + (above ? -8 : 18),
                far ? "text-anchor=\"end\" fill=\"#222\" font-size=\"11\"" : "fill=\"#222\" font-size=\"11\"",
                front[i]->label);
  }
  if (zeros)
    svg += text(left + 4, bottom - 5, "fill=\"#666\" font-size=\"11\"", "on the lower edge: no difference at all");
  for (size_t g = 0; g < scatter.groups.size(); ++g) {
    const double x = left + double(g % 4) * width / 4, y = bottom + 58 + 18 * double(g / 4);
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"/>", x + 5, y - 4, plot_color(g)) +
           text(x + 15, y, "", scatter.groups[g]);
  }
  return svg + "</svg>\n";
}

}  // namespace candela
