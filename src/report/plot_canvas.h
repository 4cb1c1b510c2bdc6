#pragma once
#include <string>
#include <utility>
#include <vector>

// What the figures of reports share: axes, and a script of gnuplot that grows from the top. All lengths are units of
// the SVG, y down; gnuplot is told every place, so that labels can be put where nothing is.
namespace candela {

struct PlotAxis {
  double low = 1, high = 10;
  bool log = true;
  std::vector<std::pair<double, std::string>> ticks;
  double at(double value) const;  // 0 at the low end, 1 at the high one; values beyond stand at the ends
};
// Around the values, from and to 1, 2 or 5 of a decade, half a decade at least. With a zero_tick the axis begins a
// decade lower, at a mark for 0.
PlotAxis log_axis(const std::vector<double>& values, bool zero_tick = false);
PlotAxis linear_axis(double highest);  // from 0
// A tick at each value where they are few, else as log_axis.
PlotAxis count_axis(const std::vector<double>& values);

// Okabe and Ito's colours, which colour-blind readers can tell apart; shapes change with them.
std::string plot_color(size_t index, bool dimmed = false);
int plot_shape(size_t index, bool open = false);  // gnuplot's point type
inline constexpr size_t plot_colors = 7;
inline constexpr const char* others_color = "#b4b9be";

// A double-quoted string of gnuplot: backslash sequences and enhanced text are off for what the user names.
std::string plot_quoted(const std::string& text);
// At most so many letters, the last an ellipsis where there were more.
std::string shortened(const std::string& text, size_t letters);
size_t letters_of(const std::string& text);

struct KeyEntry {
  std::string name, color;
  int shape = 7;  // 0: a line
  bool dashed = false;
};

class PlotCanvas {
 public:
  static constexpr double width = 960, letter = 9.4;  // of text at the usual size, at most on the average
  static constexpr double line_height = 24;

  // height: of the area of the data. left: room for what stands before it.
  PlotCanvas(const std::string& title, const std::string& y_label, double left, double height);
  void axes(const PlotAxis& x, const PlotAxis& y, const std::string& x_label);
  void key(const std::vector<KeyEntry>& entries);    // below, in as many rows as it takes
  void lines(const std::vector<std::string>& text);  // of text, below
  void text(double x, double y, const std::string& text, const char* align = "left", const char* font = "",
            const char* color = "#222222");
  // Rows of numbers, and how gnuplot shall draw them; nothing of no rows.
  void data(const std::vector<std::vector<double>>& rows, const std::string& how);
  double x_of(double value) const { return left_ + x_.at(value) * (right_ - left_); }
  double y_of(double value) const { return bottom_ - y_.at(value) * (bottom_ - top_); }
  double left() const { return left_; }
  double right() const { return right_; }
  double top() const { return top_; }
  double bottom() const { return bottom_; }
  std::string script() const;

 private:
  double left_, right_ = width - 24, top_, bottom_, height_;
  PlotAxis x_, y_;
  struct Label {
    double x, y;
    std::string text, style;
  };
  std::vector<Label> labels_;
  std::string settings_, blocks_, commands_;
  size_t blocks_count_ = 0;
};

}  // namespace candela
