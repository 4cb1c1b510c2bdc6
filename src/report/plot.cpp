#include "report/plot.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "base/files.h"
#include "base/text.h"
#include "report/golden_report.h"

extern char** environ;

namespace candela {
namespace fs = std::filesystem;
namespace {

// Okabe and Ito's colours, which colour-blind readers can tell apart, then darker ones of the same kind.
constexpr const char* colors[] = {"#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a7a00",
                                  "#7a4fa3", "#5b6b73", "#00545f", "#a33b50", "#4a7d1f", "#8c564b", "#2f3f8f"};

// A double-quoted string of gnuplot: backslash sequences and enhanced text are off for what the user names.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += uint8_t(c) < 0x20 ? ' ' : c;
  }
  return result + "\"";
}

// Runs `gnuplot -d FILE` and returns what it prints; nothing when it does not end with 0.
std::optional<std::string> output_of_gnuplot(const fs::path& script) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  // Its complaints would only confuse: the report says that the plot is missing.
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = script.string();
  char program[] = "gnuplot", defaults[] = "-d";
  char* arguments[] = {program, defaults, name.data(), nullptr};
  pid_t process = -1;
  const int error = posix_spawnp(&process, program, &files, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  std::string text;
  char buffer[65536];
  while (error == 0) {
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n > 0) text.append(buffer, size_t(n));
    if (n == 0 || (n < 0 && errno != EINTR)) break;
  }
  close(ends[0]);
  if (error != 0) return std::nullopt;
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.find("</svg>") == std::string::npos) return std::nullopt;
  return text;
}

// A round number at or below a fifth of the range, for ticks.
double tick_step(double range) {
  if (!(range > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(range / 5)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / 5 <= factor * power) return factor * power;
  return 10 * power;
}

}  // namespace

const char* plot_color(size_t index) { return colors[index % std::size(colors)]; }

bool has_gnuplot() {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path ? path : "", ':'))
    if (!folder.empty() && access((fs::path(folder) / "gnuplot").c_str(), X_OK) == 0) return true;
  return false;
}

std::string gnuplot_script(const Plot& plot, const std::string& terminal) {
  std::string s = fmt::format(
      "set terminal {} size 760,{} noenhanced background rgb 'white' font 'sans-serif,13'\n"
      "set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\n"
      "set key below Left reverse noenhanced\nset grid back linecolor rgb '#dddddd'\nset border linecolor rgb "
      "'#555555'\n",
      terminal, 400 + 20 * plot.lines.size(), quoted(plot.title), quoted(plot.x_label), quoted(plot.y_label));
  // Numbers of lights are mostly powers of 4.
  if (plot.log_x) s += "set logscale x\nset xtics 1,4\n";
  s += plot.log_y ? "set logscale y\n" : "set yrange [0:*]\n";
  s += "set format x '%.0f'\nset format y '%g'\n";
  size_t k = 0;
  std::string commands;
  for (const PlotLine& line : plot.lines) {
    s += fmt::format("$data{} << END\n", k);
    size_t points = 0;
    for (size_t i = 0; i < line.x.size(); ++i) {
      // Logarithms have no place for 0.
      if (!std::isfinite(line.y[i]) || (plot.log_x && !(line.x[i] > 0)) || (plot.log_y && !(line.y[i] > 0))) continue;
      s += fmt::format("{} {}\n", line.x[i], line.y[i]);
      ++points;
    }
    s += "END\n";
    if (points > 0)
      commands += fmt::format(
          "{}$data{} using 1:2 with linespoints linewidth 2 pointtype 7 pointsize 0.5 linecolor rgb "
          "'{}' title {} noenhanced",
          commands.empty() ? "plot " : ", ", k, plot_color(k), quoted(line.name));
    ++k;
  }
  return s + commands + "\n";
}

std::optional<std::string> gnuplot_svg(const Plot& plot) {
  static int count = 0;
  const fs::path script = fs::temp_directory_path() / fmt::format("candela-plot-{}-{}.gp", getpid(), count++);
  if (!write_file_atomically(script, std::string_view(gnuplot_script(plot)))) return std::nullopt;
  auto svg = output_of_gnuplot(script);
  std::error_code ignored;
  fs::remove(script, ignored);
  return svg;
}

std::string stacked_bars_svg(const std::vector<Bar>& bars, const std::string& unit) {
  std::vector<std::string> names;
  double longest = 0;
  size_t label_length = 0;
  for (const Bar& bar : bars) {
    double sum = 0;
    for (const auto& [name, value] : bar.parts) {
      sum += value;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    longest = std::max(longest, sum);
    label_length = std::max(label_length, bar.label.size());
  }
  // All in user units that a browser shows as pixels at 13 px text: a letter is about 7 wide.
  const double left = 16 + 7.0 * double(label_length), width = 620, row = 24, top = 8;
  const double height = top + row * double(bars.size()) + 26;
  const double legend_row = 20;
  const size_t legend_columns = 5, legend_rows = (names.size() + legend_columns - 1) / legend_columns;
  const double scale = longest > 0 ? width / longest : 0, all_width = left + width + 90;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n",
      all_width, height + legend_row * double(legend_rows) + 6);
  const double step = tick_step(longest), bottom = top + row * double(bars.size());
  for (double at = 0; longest > 0 && at <= longest * 1.0001; at += step)
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
        "text-anchor=\"middle\" fill=\"#666\">{4:g}</text>\n",
        left + at * scale, top, bottom + 4, bottom + 18, at);
  for (size_t b = 0; b < bars.size(); ++b) {
    const double y = top + row * double(b);
    double x = left, sum = 0;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left - 8, y + 15,
                       escape_markup(bars[b].label));
    for (const auto& [name, value] : bars[b].parts) {
      const size_t color = size_t(std::find(names.begin(), names.end(), name) - names.begin());
      svg += fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.0f}\" fill=\"{}\"><title>{} "
          "{:.4g} {}</title></rect>\n",
          x, y + 2, value * scale, row - 5, plot_color(color), escape_markup(name), value, escape_markup(unit));
      x += value * scale;
      sum += value;
    }
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#444\">{:.4g} {}</text>\n", x + 6, y + 15, sum,
                       escape_markup(unit));
  }
  for (size_t i = 0; i < names.size(); ++i) {
    const double x = 8 + double(i % legend_columns) * (all_width - 16) / double(legend_columns);
    const double y = height + legend_row * double(i / legend_columns);
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{:.1f}\" "
        "y=\"{:.1f}\">{}</text>\n",
        x, y, plot_color(i), x + 17, y + 11, escape_markup(names[i]));
  }
  return svg + "</svg>\n";
}

void FigureFiles::add(const std::string& title, const std::string& svg) {
  if (svg.empty()) return;
  constexpr size_t longest = 60;
  std::string name;
  for (const char c : title) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    const bool capital = c >= 'A' && c <= 'Z';
    if (name.size() >= longest) break;
    if (kept || capital)
      name += capital ? char(c - 'A' + 'a') : c;
    else if (!name.empty() && name.back() != '-')
      name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  files.emplace_back(fmt::format("{:02}-{}.svg", files.size() + 1, name), svg);
}

std::string stacked_shares_svg(std::vector<Bar> bars) {
  for (Bar& bar : bars) {
    double sum = 0;
    for (const auto& part : bar.parts) sum += part.second;
    for (auto& part : bar.parts) part.second *= sum > 0 ? 100 / sum : 0;
  }
  return stacked_bars_svg(bars, "%");
}

}  // namespace candela
