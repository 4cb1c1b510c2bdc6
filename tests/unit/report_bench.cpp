#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/files.h"
#include "report/bench_report.h"
#include "report/bench_rows.h"
#include "report/plot.h"

namespace candela {
namespace {

BenchRow row_of(int lights, double ms) {
  BenchRow row;
  row.suite = "lights", row.scene = "street <b>", row.scene_content = "c0ffee", row.technique = "brute-force";
  row.quality = "high", row.output = "exr", row.settings = "cull.enabled=1";
  row.lights = row.lights_wanted = lights, row.seed = 3;
  row.width_px = 64, row.height_px = 32, row.samples = 4, row.time_s = 0.5;
  row.device = "llvmpipe", row.driver = "Mesa", row.device_class = "lavapipe", row.device_type = "cpu";
  row.machine = "a processor", row.cores = 2, row.version = "0.1";
  row.plan_hash = "0123456789abcdef", row.knob_hash = "feed", row.job = R"({"scene":"street"})";
  row.warm_up_frames = 3, row.runs_capped = true;
  row.frame = {"frame", {ms, ms + 1, ms + 2}};
  row.gpu = {"gpu", {ms, ms, ms}};
  row.passes = {{"cull", {1, 1, 1}}, {"shade", {ms - 1, ms - 1, ms - 1}}};
  row.cpu = {{"wait", {0.5, 0.5, 0.5}}};
  row.opening_ms = {{"load", 12}};
  row.memory = {{"scene_bytes", 1 << 20}, {"device_peak_bytes", 3 << 20}};
  row.picture = {"brute-force", "", 0, 0};
  row.lists = LightLists{10, 20, 30, 0.25, 0};
  row.thumbnail = {std::byte('f'), std::byte('o'), std::byte('o')};
  return row;
}

BenchRun run_of(std::vector<BenchRow> rows) { return {std::move(rows), {"a note & more"}, 12.5}; }

TEST(BenchRows, ComeBackFromJson) {
  BenchRun run = run_of({row_of(4, 10), row_of(16, 20)});
  run.rows[1].lists.reset();
  run.rows[1].lists_note = "none";
  run.rows[1].picture = {"brute-force", "limited", 7, std::numeric_limits<double>::infinity()};
  run.rows[1].error = "out of memory", run.rows[1].error_kind = 6;
  const auto file = std::filesystem::path(testing::TempDir()) / "bench_rows.json";
  ASSERT_TRUE(write_file_atomically(file, bench_json(run).dump()));
  const auto again = read_bench_rows(file);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(bench_json(*again).dump(), bench_json(run).dump());
  EXPECT_EQ(row_key(again->rows[0]), row_key(run.rows[0]));
  EXPECT_EQ(again->rows[0].frame.ms, run.rows[0].frame.ms);
  EXPECT_TRUE(std::isinf(again->rows[1].picture.max_difference));
  std::filesystem::remove(file);
}

TEST(BenchRows, BrokenFilesAreNamed) {
  const auto file = std::filesystem::path(testing::TempDir()) / "bench_broken.json";
  for (const char* text : {"", "[]", "{}", R"({"candela_bench": 1})", R"({"candela_bench": 1, "rows": [{}]})",
                           R"({"candela_bench": 2, "rows": []})"}) {
    ASSERT_TRUE(write_file_atomically(file, std::string_view(text)));
    const auto rows = read_bench_rows(file);
    ASSERT_FALSE(rows) << text;
    EXPECT_EQ(rows.error().kind, ErrorKind::input);
    EXPECT_NE(rows.error().place.find("bench_broken.json"), std::string::npos);
  }
  std::filesystem::remove(file);
}

TEST(BenchCsv, HasALineARowAndQuotesWhatNeedsIt) {
  BenchRun run = run_of({row_of(4, 10), row_of(16, 20)});
  run.rows[0].settings = "a=\"1\", b";
  run.rows[1].passes.push_back({"extra", {4, 4, 4}});
  const std::string csv = bench_csv(run);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_NE(csv.find("\"a=\"\"1\"\", b\""), std::string::npos);
  EXPECT_NE(csv.find(",gpu.cull_ms,gpu.shade_ms,gpu.extra_ms,cpu.wait_ms,"), std::string::npos);
  // Without the quoted cell, all lines have as many cells.
  const std::string plain = bench_csv(run_of({row_of(4, 10), row_of(16, 20)}));
  size_t cells = 0, line_cells = 0;
  for (const char c : plain) {
    line_cells += c == ',';
    if (c != '\n') continue;
    if (cells == 0) cells = line_cells;
    EXPECT_EQ(line_cells, cells);
    line_cells = 0;
  }
}

TEST(BenchHtml, IsOneFileWithEverythingEscaped) {
  const std::string html = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "a <title>", false);
  EXPECT_EQ(html.find("street <b>"), std::string::npos);
  EXPECT_NE(html.find("street &lt;b&gt;"), std::string::npos);
  EXPECT_NE(html.find("a &lt;title&gt;"), std::string::npos);
  EXPECT_NE(html.find("a note &amp; more"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,Zm9v"), std::string::npos);
  EXPECT_NE(html.find("01234567"), std::string::npos) << "the plan's hash";
  for (const char* outside : {"<script", "<link", "src=\"http", "src=\"/", "url("})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
}

TEST(BenchHtml, WithoutGnuplotItSaysSoAndKeepsTheTables) {
  const std::string html = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", false);
  EXPECT_NE(html.find("gnuplot is not installed"), std::string::npos);
  EXPECT_NE(html.find("exponent"), std::string::npos);
  EXPECT_EQ(html.find("image/svg+xml"), std::string::npos);
}

TEST(BenchHtml, NotesAreFoldedBehindWhatWasFound) {
  const std::string html = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", false);
  const size_t found = html.find("exponent"), folded = html.find("<details><summary>Notes ("),
               note = html.find("a note &amp; more");
  ASSERT_NE(note, std::string::npos);
  EXPECT_LT(found, folded);
  EXPECT_LT(folded, note);
}

TEST(BenchHtml, FiguresAreFilesToo) {
  FigureFiles figures;
  bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", has_gnuplot(), &figures);
  std::vector<std::string> names;
  for (const auto& [name, svg] : figures.files) {
    names.push_back(name);
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << name;
  }
  ASSERT_GE(names.size(), 2u);
  EXPECT_EQ(names[0], "01-time-of-the-passes.svg");
  EXPECT_EQ(names[1], "02-shares-of-the-passes.svg");
  if (has_gnuplot()) EXPECT_EQ(names.at(2), "03-frame-time.svg");
  figures = {};
  figures.add("A <b> / \"c\" ../d", "<svg/>"), figures.add("empty", "");
  ASSERT_EQ(figures.files.size(), 1u);
  EXPECT_EQ(figures.files[0].first, "01-a-b-c-d.svg");
}

// Passes are timed one by one, each alone: their sum is another quantity than the frame's time.
TEST(BenchHtml, FramesAndPassesShareNoTable) {
  const std::string html = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", false);
  size_t frames = 0, passes = 0;
  for (size_t at = html.find("<table>"); at != std::string::npos; at = html.find("<table>", at + 1)) {
    const std::string table = html.substr(at, html.find("</table>", at) - at);
    const bool of_frames = table.find(">frame, ms<") != std::string::npos;
    const bool of_passes = table.find(">sum of passes<") != std::string::npos;
    frames += of_frames, passes += of_passes;
    EXPECT_FALSE(of_frames && (of_passes || table.find(">shade<") != std::string::npos)) << table;
  }
  EXPECT_EQ(frames, 1u);
  EXPECT_EQ(passes, 1u);
}

TEST(BenchRun, NamesRowsThatHaveNoRuns) {
  BenchRow left = row_of(16, 0), stopped = row_of(64, 0), failed = row_of(256, 0);
  left.frame.ms.clear(), left.left_out = "the suite limits it";
  stopped.frame.ms.clear();
  failed.frame.ms.clear(), failed.error = "out of memory";
  const auto titles = rows_without_runs(run_of({row_of(4, 10), left, stopped, failed}));
  EXPECT_EQ(titles, (std::vector<std::string>{row_title(stopped), row_title(failed)}));
}

TEST(BenchHtml, DevicesDoNotShareAxes) {
  BenchRow gpu = row_of(4, 1);
  gpu.device = "Some GPU", gpu.device_type = "discrete";
  const std::string one = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", false);
  const std::string two = bench_html(run_of({row_of(4, 10), gpu}), "t", false);
  const auto count = [](const std::string& text, std::string_view part) {
    size_t n = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count(one, "<h3>Time of the passes"), 1u);
  EXPECT_EQ(count(two, "<h3>Time of the passes"), 2u);
  EXPECT_NE(two.find("Rows of 2 devices"), std::string::npos);
  EXPECT_EQ(one.find("Rows of"), std::string::npos);
}

TEST(BenchHtml, ShowsWhatIsWrongAndWhatIsLeftOut) {
  BenchRow wrong = row_of(4, 10), left = row_of(16, 0), failed = row_of(64, 0);
  wrong.picture.differing = 12345;
  wrong.remarks = {"3 lights are LOST"};
  left.frame.ms.clear(), left.left_out = "the suite limits it";
  failed.frame.ms.clear(), failed.error = "out of memory";
  const std::string html = bench_html(run_of({wrong, left, failed}), "t", false);
  EXPECT_NE(html.find("<td class=\"bad\">12345</td>"), std::string::npos);
  EXPECT_NE(html.find("the suite limits it"), std::string::npos);
  EXPECT_NE(html.find("out of memory"), std::string::npos);
  EXPECT_NE(html.find("3 lights are LOST"), std::string::npos);
}

TEST(Plot, NamesCannotLeaveTheirQuotes) {
  const std::string script =
      gnuplot_script({.title = "a\"; system(\"b\")\nset output 'c'", .lines = {{"l\\\"", {1, 2}, {1, 2}}}});
  EXPECT_NE(script.find("set title \"a\\\"; system(\\\"b\\\") set output 'c'\""), std::string::npos) << script;
  EXPECT_NE(script.find("title \"l\\\\\\\"\""), std::string::npos) << script;
}

TEST(Plot, WhatHasNoLogarithmIsNotDrawn) {
  const std::string script = gnuplot_script({.title = "t", .lines = {{"some", {0, 4}, {1, 2}}, {"none", {4}, {0}}}});
  EXPECT_EQ(script.find("0 1\n"), std::string::npos);
  EXPECT_NE(script.find("4 2\n"), std::string::npos);
  EXPECT_EQ(script.find("title \"none\""), std::string::npos);
}

TEST(Plot, GnuplotDrawsWhenItIsThere) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const auto svg = gnuplot_svg({.title = "Frame time", .lines = {{"brute <force>", {1, 4, 16}, {1, 2, 8}}}});
  ASSERT_TRUE(svg);
  EXPECT_NE(svg->find("Frame time"), std::string::npos);
  EXPECT_NE(svg->find("brute &lt;force"), std::string::npos);
  EXPECT_FALSE(gnuplot_svg({.title = "nothing to draw"})) << "an error of gnuplot is no picture";
}

TEST(Bars, AreStackedToOneScale) {
  const std::string svg = stacked_bars_svg({{"a & b", {{"x", 1}, {"y", 3}}}, {"c", {{"y", 2}}}}, "ms");
  EXPECT_NE(svg.find("a &amp; b"), std::string::npos);
  EXPECT_NE(svg.find("width=\"155.00\""), std::string::npos) << "a fourth of 620: " << svg;
  EXPECT_NE(svg.find("width=\"465.00\""), std::string::npos);
  EXPECT_NE(svg.find("width=\"310.00\""), std::string::npos);
  EXPECT_NE(stacked_shares_svg({{"a", {{"x", 1}, {"y", 3}}}, {"c", {{"y", 2}}}}).find("width=\"620.00\""),
            std::string::npos);
  EXPECT_NE(stacked_bars_svg({}, "ms").find("</svg>"), std::string::npos);
}

TEST(ComparisonJson, HoldsEveryJudgement) {
  const auto compared = compare_rows({row_of(4, 10), row_of(64, 1)}, {row_of(4, 30)}, {});
  ASSERT_TRUE(compared);
  const auto json = comparison_json(*compared);
  EXPECT_TRUE(json["slower"]);
  EXPECT_EQ(json["changes"][0]["quantity"], "frame");
  EXPECT_EQ(json["changes"][0]["verdict"], "slower");
  EXPECT_EQ(json["only_old"].size(), 1u);
}

}  // namespace
}  // namespace candela
