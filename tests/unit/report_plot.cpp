#include <gtest/gtest.h>

#include <fmt/format.h>

#include "report/figures.h"
#include "report/gnuplot.h"
#include "report/plot.h"
#include "report/plot_canvas.h"

namespace candela {
namespace {

std::vector<double> values(const PlotAxis& axis) {
  std::vector<double> ticks;
  for (const auto& tick : axis.ticks) ticks.push_back(tick.first);
  return ticks;
}
std::vector<std::string> names(const PlotAxis& axis) {
  std::vector<std::string> ticks;
  for (const auto& tick : axis.ticks) ticks.push_back(tick.second);
  return ticks;
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

LinePlot lines() {
  return {.title = "Time",
          .x_label = "lights",
          .y_label = "ms",
          .lines = {{"brute <force>", {{1, 1, {}, {0.9, 1.25}}, {4, 2, {}, {}}, {16, 8, {}, {7, 9}}}},
                    {"none", {{4, 0, {}, {}}}}}};
}
ScatterPlot scatter() {
  return {.title = "Errors",
          .x_label = "ms",
          .y_label = "relmse",
          .points = {{"quick one", {1, 0.1, {0.9, 1.1}, {0.05, 0.2}}, 0},
                     {"exact one", {10, 0, {}, {}}, 1},
                     {"worse one", {20, 0.5, {}, {}}, 0, true},
                     {"unsure one", {2, 0.1, {}, {}}, 1, false, true}},
          .groups = {"clustered", "forward-plus"},
          .floor_y = 0.003};
}
BarPlot bars(double first, double second) {
  return {.title = "Passes",
          .x_label = "ms",
          .unit = "ms",
          .bars = {{"a & b", first, {first * 0.9, first * 1.1}, {{"x", first / 4}, {"y", first * 3 / 4}}},
                   {"c", second, {}, {{"y", second}}}}};
}

TEST(PlotAxis, TicksAtOneTwoAndFiveOrAtDecades) {
  EXPECT_EQ(values(log_axis({8, 47})), (std::vector<double>{5, 10, 20, 50}));
  EXPECT_EQ(names(log_axis({3e-5, 0.3})), (std::vector<std::string>{"10⁻⁴", "0.001", "0.01", "0.1"}));
  const PlotAxis one = log_axis({3});
  EXPECT_GE(one.high / one.low, 4.9);
  EXPECT_EQ(names(log_axis({0.02, 0.3}, true)).front(), "0") << "a mark below all that has a logarithm";
  EXPECT_EQ(values(linear_axis(5.5)), (std::vector<double>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(values(count_axis({16, 1, 4, 4})), (std::vector<double>{1, 4, 16}));
  EXPECT_DOUBLE_EQ(log_axis({1, 100}).at(10), 0.5);
}

TEST(Plot, NamesCannotLeaveTheirQuotes) {
  const std::string script = plot_script(
      LinePlot{.title = "a\"; system(\"b\")\nset output 'c'", .lines = {{"l\\\"", {{1, 1, {}, {}}, {2, 2, {}, {}}}}}});
  EXPECT_TRUE(has(script, "set label \"a\\\"; system(\\\"b\\\") set output 'c'\"")) << script;
  EXPECT_TRUE(has(script, "set label \"l\\\\\\\"\"")) << script;
}

TEST(Plot, LinesHaveErrorBarsAndLeaveOutWhatHasNoLogarithm) {
  const std::string script = plot_script(lines());
  EXPECT_TRUE(has(script, "1 1 0.9 1.25\n16 8 7 9\nEND")) << "bars where there are intervals: " << script;
  EXPECT_TRUE(has(script, "1:3:(0):($4-$3) with vectors heads"));
  EXPECT_FALSE(has(script, "4 0")) << script;
  EXPECT_FALSE(has(script, "\"none\"")) << "no key of a line that has no points";
  LinePlot linear = lines();
  linear.log_y = false;
  EXPECT_TRUE(has(plot_script(linear), "4 0"));
  EXPECT_EQ(plot_script(LinePlot{.title = "t"}), "");
}

TEST(Plot, ScatterNumbersItsFrontAndSaysWhatIsNotSure) {
  const std::string script = plot_script(scatter());
  EXPECT_TRUE(has(script, "\"1   quick one\"") && has(script, "\"2   exact one\"")) << script;
  EXPECT_FALSE(has(script, "worse one") || has(script, "unsure one")) << script;
  EXPECT_TRUE(has(script, "noise of the reference"));
  EXPECT_TRUE(has(script, "not distinguishable from the front") && has(script, "dominated"));
  EXPECT_TRUE(has(script, "1 0.1 0.9 1.1\nEND") && has(script, "1 0.1 0.05 0.2\nEND")) << "both error bars: " << script;
  EXPECT_TRUE(has(script, "(\"0\" ")) << "an error of 0 has a mark on the axis: " << script;
  EXPECT_EQ(plot_script(ScatterPlot{}), "");
  ScatterPlot close = scatter();
  close.points[1].at = {1.01, 0.099, {}, {}};
  EXPECT_TRUE(has(plot_script(close), "\"1–2\"")) << "points on one spot have one text";
  ScatterPlot law = scatter();
  law.stairs = false, law.curve = {{1, 1}, {10, 10}};
  EXPECT_TRUE(has(plot_script(law), "law that was fitted"));
  EXPECT_FALSE(has(plot_script(law), "with steps"));
}

TEST(Plot, BarsAreStackedOrDividedOnALogarithm) {
  const std::string near = plot_script(bars(4, 2));
  EXPECT_FALSE(has(near, "set logscale x"));
  EXPECT_TRUE(has(near, "0 1.5 0 1 1.12 1.88")) << "x of a, stacked: " << near;
  EXPECT_TRUE(has(near, "1 1.5 1 4 1.12 1.88")) << near;
  EXPECT_TRUE(has(near, "4 1.5 3.6 4.4\nEND")) << "the error bar: " << near;
  const std::string far = plot_script(bars(400, 4));
  EXPECT_TRUE(has(far, "set logscale x"));
  // From 2, a quarter of the way to 400 in logarithms.
  EXPECT_TRUE(has(far, fmt::format("2 1.5 2 {} ", 2 * std::pow(200.0, 0.25)))) << far;
  const BarPlot parts = shares(bars(400, 4));
  EXPECT_FALSE(has_log_axis(parts));
  EXPECT_TRUE(has(plot_script(parts), "25 1.5 25 100")) << plot_script(parts);
  EXPECT_EQ(plot_script(BarPlot{}), "");
  BarPlot counts = bars(400, 4);
  counts.may_be_log = false;
  EXPECT_FALSE(has(plot_script(counts), "set logscale x"));
}

TEST(Plot, SmallPartsOfBarsAreOne) {
  BarPlot plot{.title = "t", .bars = {{"a", 100, {}, {}}}};
  for (int i = 0; i < 12; ++i) plot.bars[0].parts.emplace_back(fmt::format("p{:02}", i), 12 - i);
  const std::string script = plot_script(plot);
  EXPECT_TRUE(has(script, "\"p06\"") && has(script, "\"others\""));
  EXPECT_FALSE(has(script, "\"p07\""));
}

TEST(Plot, LongNamesAreShortened) {
  EXPECT_EQ(shortened("abcdef", 4), "abc…");
  EXPECT_EQ(shortened("äöüß", 4), "äöüß");
  EXPECT_EQ(shortened("äöüßx", 4), "äöü…");
}

TEST(Plot, GnuplotDrawsAllKindsTheSameWayEachTime) {
  ASSERT_TRUE(has_gnuplot()) << "the package gnuplot-nox is missing: ./run install";
  for (const std::string& script :
       {plot_script(lines()), plot_script(scatter()), plot_script(bars(400, 4)), plot_script(bars(4, 2))}) {
    const auto svg = gnuplot_svg(script), again = gnuplot_svg(script);
    ASSERT_TRUE(svg && again) << script;
    EXPECT_EQ(*svg, *again);
    EXPECT_TRUE(has(*svg, "viewBox=\"0 0 960 "));
  }
  EXPECT_TRUE(has(*gnuplot_svg(plot_script(lines())), "brute &lt;force"));
  EXPECT_TRUE(has(*gnuplot_svg(plot_script(bars(400, 4))), "a &amp; b"));
  EXPECT_FALSE(gnuplot_svg("plot")) << "an error of gnuplot is no picture";
}

TEST(Figures, AreNamedInOrderAndEscaped) {
  Figures none(false);
  EXPECT_EQ(none.add("t", plot_script(lines())), "");
  EXPECT_TRUE(none.files().empty());
  ASSERT_TRUE(has_gnuplot()) << "the package gnuplot-nox is missing: ./run install";
  Figures figures(true);
  EXPECT_TRUE(has(figures.add("A <b> / \"c\" ../d", plot_script(lines()), "<caption>"), "&lt;caption&gt;"));
  EXPECT_EQ(figures.add("empty", ""), "");
  EXPECT_TRUE(has(figures.add("broken", "plot"), "gnuplot could not draw: broken"));
  ASSERT_EQ(figures.files().size(), 1u);
  EXPECT_EQ(figures.files()[0].first, "01-a-b-c-d.svg");
}

}  // namespace
}  // namespace candela
