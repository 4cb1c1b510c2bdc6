#include "report/plot_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace candela {
namespace {

constexpr std::array<unsigned, plot_colors> colors = {0x0072b2, 0xe69f00, 0x009e73, 0xcc79a7,
                                                      0x56b4e9, 0xd55e00, 0x333333};
constexpr int shapes[] = {7, 5, 9, 13, 11};

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

std::string superscript(int number) {
  static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
  return text;
}
std::string tick_text(double v) {
  if (v == 0) return "0";
  if (v >= 0.001 * (1 - 1e-9) && v < 1e6) return fmt::format("{:.6g}", v);
  const int decade = int(std::floor(std::log10(v) + 1e-9));
  const double lead = v / std::pow(10, decade);
  return (lead > 1.01 ? fmt::format("{:.0f}·", lead) : "") + "10" + superscript(decade);
}

// Decades where there are many, and 2 and 5 of them where there is room.
void tick_decades(PlotAxis& axis) {
  const double range = std::log10(axis.high / axis.low);
  const int every = std::max(1, int(std::ceil(range / 8)));
  for (double tick = step_above(axis.low); tick < axis.high * 1.001; tick = step_above(tick * 1.01)) {
    const double decade = std::log10(tick), whole = std::round(decade);
    const bool is_decade = std::abs(decade - whole) < 1e-6;
    if (range < 2.51 || (is_decade && int(whole) % every == 0)) axis.ticks.emplace_back(tick, tick_text(tick));
  }
}

}  // namespace

double PlotAxis::at(double value) const {
  const double v = std::clamp(value, low, high);
  return log ? std::log(v / low) / std::log(high / low) : (v - low) / (high - low);
}

PlotAxis log_axis(const std::vector<double>& values, bool zero_tick) {
  PlotAxis axis;
  double low = 0, high = 0;
  for (const double v : values)
    if (v > 0 && std::isfinite(v)) low = low == 0 ? v : std::min(low, v), high = std::max(high, v);
  if (high > 0) axis.low = step_below(low), axis.high = step_above(high);
  for (bool lower = true; axis.high / axis.low < 4.9; lower = !lower)
    lower ? axis.low = step_below(axis.low * 0.99) : axis.high = step_above(axis.high * 1.01);
  if (zero_tick) axis.low /= 10;
  tick_decades(axis);
  if (!zero_tick) return axis;
  std::erase_if(axis.ticks, [&](const auto& tick) { return tick.first < axis.low * 9.9; });
  axis.ticks.insert(axis.ticks.begin(), {axis.low, "0"});
  return axis;
}

PlotAxis linear_axis(double highest) {
  PlotAxis axis{.low = 0, .high = 1, .log = false, .ticks = {}};
  const double step = highest > 0 ? step_above(highest / 6 * 0.999) : 0.2;
  axis.high = highest > 0 ? step * std::ceil(highest / step * 0.9999) : 1;
  for (int i = 0; i * step <= axis.high * 1.0001; ++i)
    axis.ticks.emplace_back(i * step, fmt::format("{:.6g}", i * step));
  return axis;
}

PlotAxis count_axis(const std::vector<double>& values) {
  PlotAxis axis = log_axis(values);
  std::vector<double> sorted;
  for (const double v : values)
    if (v > 0) sorted.push_back(v);
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.empty()) return axis;
  axis.low = sorted.front() / 1.25, axis.high = sorted.back() * 1.25;
  const auto near = [&](size_t i) { return i > 0 && axis.at(sorted[i]) - axis.at(sorted[i - 1]) < 0.08; };
  bool crowded = sorted.size() > 12;
  for (size_t i = 0; i < sorted.size(); ++i) crowded = crowded || near(i);
  axis.ticks.clear();
  if (crowded)
    tick_decades(axis);
  else
    for (const double v : sorted) axis.ticks.emplace_back(v, tick_text(v));
  return axis;
}

std::string plot_color(size_t index, bool dimmed) {
  const unsigned rgb = colors[index % colors.size()];
  const auto part = [&](int shift) {
    const unsigned c = rgb >> shift & 0xff;
    return dimmed ? 255 - (255 - c) * 35 / 100 : c;
  };
  return fmt::format("#{:02x}{:02x}{:02x}", part(16), part(8), part(0));
}

int plot_shape(size_t index, bool open) { return shapes[index % std::size(shapes)] - int(open); }

std::string plot_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += uint8_t(c) < 0x20 ? ' ' : c;
  }
  return result + "\"";
}

size_t letters_of(const std::string& text) {
  return size_t(std::count_if(text.begin(), text.end(), [](char c) { return (uint8_t(c) & 0xc0) != 0x80; }));
}

std::string shortened(const std::string& text, size_t letters) {
  if (letters_of(text) <= letters) return text;
  size_t end = 0;
  for (size_t kept = 0; kept + 1 < letters; ++kept) {
    ++end;
    while (end < text.size() && (uint8_t(text[end]) & 0xc0) == 0x80) ++end;
  }
  return text.substr(0, end) + "…";
}

PlotCanvas::PlotCanvas(const std::string& title, const std::string& y_label, double left, double height)
    : left_(left), top_(y_label.empty() ? 58 : 84), bottom_(top_ + height), height_(bottom_ + 8) {
  text(20, 26, shortened(title, 80), "left", ",19");
  if (!y_label.empty()) text(20, 56, shortened(y_label, 95), "left", "", "#555555");
}

void PlotCanvas::axes(const PlotAxis& x, const PlotAxis& y, const std::string& x_label) {
  x_ = x, y_ = y;
  const auto tick_list = [](const PlotAxis& axis) {
    std::string list;
    for (const auto& [value, name] : axis.ticks)
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", plot_quoted(name), value);
    return list;
  };
  for (const auto& [name, axis] : {std::pair('x', &x_), {'y', &y_}}) {
    settings_ += fmt::format("set {}range [{}:{}]\n", name, axis->low, axis->high);
    if (axis->log) settings_ += fmt::format("set logscale {}\n", name);
    if (axis->ticks.empty())
      settings_ += fmt::format("unset {}tics\n", name);
    else
      settings_ += fmt::format("set {}tics nomirror scale 0 textcolor rgb '#444444' ({})\n", name, tick_list(*axis));
  }
  height_ = bottom_ + 30;
  if (x_label.empty()) return;
  const std::string label = shortened(x_label, 95);
  const double half = letter * double(letters_of(label)) / 2;
  text(std::min((left_ + right_) / 2, width - 8 - half), bottom_ + 44, label, "center", "", "#555555");
  height_ = bottom_ + 64;
}

void PlotCanvas::key(const std::vector<KeyEntry>& entries) {
  if (entries.empty()) return;
  double x = 24;
  height_ += 12;
  for (const KeyEntry& entry : entries) {
    const std::string name = shortened(entry.name, 90);
    const double wide = 22 + letter * double(letters_of(name)) + 22;
    if (x > 24 && x + wide > width) x = 24, height_ += line_height;
    if (entry.shape > 0)
      labels_.push_back(
          {x + 6, height_, "", fmt::format("point pt {} ps 1.1 lw 2 lc rgb '{}'", entry.shape, entry.color)});
    else
      text(x + 6, height_, entry.dashed ? "- -" : "—", "center", ",17", entry.color.c_str());
    text(x + 22, height_, name);
    x += wide;
  }
  height_ += line_height / 2 + 4;
}

void PlotCanvas::lines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    height_ += line_height / 2;
    text(24, height_, shortened(line, 96), "left", "", "#333333");
    height_ += line_height / 2;
  }
}

void PlotCanvas::text(double x, double y, const std::string& text, const char* align, const char* font,
                      const char* color) {
  labels_.push_back(
      {x, y, text, fmt::format("{} noenhanced font '{}' textcolor rgb '{}'", align, *font ? font : ",15", color)});
}

void PlotCanvas::data(const std::vector<std::vector<double>>& rows, const std::string& how) {
  if (rows.empty()) return;
  blocks_ += fmt::format("$data{} << END\n", blocks_count_);
  for (const auto& row : rows) blocks_ += fmt::format("{}\n", fmt::join(row, " "));
  blocks_ += "END\n";
  commands_ += fmt::format("{}$data{} using {}", commands_.empty() ? "plot " : ", \\\n  ", blocks_count_, how);
  ++blocks_count_;
}

std::string PlotCanvas::script() const {
  if (commands_.empty()) return {};
  const double height = height_ + 8;
  std::string s = fmt::format(
      "set terminal svg size {:.0f},{:.0f} noenhanced background rgb 'white' font 'sans-serif,15'\n"
      "set encoding utf8\nset lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
      "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n"
      "unset key\nset border 3 linecolor rgb '#888888'\n"
      "set grid xtics ytics back linecolor rgb '#e2e4e8' linewidth 1 linetype 1\n",
      width, height, left_ / width, right_ / width, 1 - top_ / height, 1 - bottom_ / height);
  s += settings_;
  for (const Label& label : labels_)
    s += fmt::format("set label {} at screen {:.5f}, screen {:.5f} {}\n", plot_quoted(label.text), label.x / width,
                     1 - label.y / height, label.style);
  return s + blocks_ + commands_ + "\n";
}

}  // namespace candela
