#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/files.h"
#include "report/bench_report.h"
#include "report/bench_rows.h"
#include "report/gnuplot.h"
#include "report/markup.h"

namespace candela::report_bench {
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

std::string tables_html(const BenchRun& run, const std::string& title) {
  Figures none(false);
  return bench_html(run, title, none);
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
  const std::string html = tables_html(run_of({row_of(4, 10), row_of(16, 20)}), "a <title>");
  EXPECT_EQ(html.find("street <b>"), std::string::npos);
  EXPECT_NE(html.find("street &lt;b&gt;"), std::string::npos);
  EXPECT_NE(html.find("a &lt;title&gt;"), std::string::npos);
  EXPECT_NE(html.find("a note &amp; more"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,Zm9v"), std::string::npos);
  EXPECT_NE(html.find("01234567"), std::string::npos) << "the plan's hash";
  for (const char* outside : {"<script", "<link", "src=\"http", "src=\"/", "url(", "@import"})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
}

TEST(BenchHtml, WithoutGnuplotItSaysSoAndKeepsTheTables) {
  const std::string html = tables_html(run_of({row_of(4, 10), row_of(16, 20)}), "t");
  EXPECT_NE(html.find("gnuplot is not installed"), std::string::npos);
  EXPECT_NE(html.find("exponent"), std::string::npos);
  EXPECT_EQ(html.find("image/svg+xml"), std::string::npos);
}

TEST(BenchHtml, FindingsComeFirstAndNotesLast) {
  BenchRow slow = row_of(16, 60), quick = row_of(16, 20);
  for (BenchRow* row : {&slow, &quick}) {
    const double ms = row->frame.ms[0];
    row->frame.ms = {ms, ms + 1, ms + 2, ms + 1, ms, ms + 2, ms + 1};
  }
  quick.technique = "clustered", quick.source = "gabcdef";
  const std::string html = tables_html(run_of({slow, quick}), "t");
  const size_t found = html.find("16 lights: clustered cull.enabled=1 is the quickest with 21 ms"),
               facts = html.find("llvmpipe on a processor"), program = html.find("candela 0.1, commit gabcdef"),
               table = html.find("<table"), folded = html.find("<summary>Notes (1)"),
               note = html.find("a note &amp; more");
  ASSERT_NE(found, std::string::npos) << html;
  EXPECT_NE(html.find("brute-force cull.enabled=1 takes 2.90 times as long"), std::string::npos);
  EXPECT_NE(html.find("all 2 pictures are equal"), std::string::npos);
  EXPECT_LT(found, facts);
  EXPECT_LT(facts, program);
  EXPECT_LT(program, table);
  EXPECT_LT(table, folded);
  EXPECT_LT(folded, note);
}

TEST(BenchHtml, WhatIsNotSureIsNotSaidToBeQuicker) {
  BenchRow one = row_of(16, 20), other = row_of(16, 20.5);
  one.technique = "clustered";
  one.frame.ms = {20, 22, 20, 22, 20, 22}, other.frame.ms = {21, 20, 22, 21, 20, 23};
  const std::string html = tables_html(run_of({one, other}), "t");
  EXPECT_NE(html.find("is not distinguishable from it"), std::string::npos);
  EXPECT_EQ(html.find("times as long"), std::string::npos);
}

TEST(BenchHtml, APictureOfTheSceneIsKeptWithTheRows) {
  BenchRun run = run_of({row_of(4, 10), row_of(16, 20), row_of(16, 30)});
  run.rows[1].thumbnail.push_back(std::byte('x'));
  const auto json = bench_json(run);
  EXPECT_FALSE(json["rows"][0].contains("thumbnail"));
  EXPECT_EQ(json["rows"][1]["thumbnail"], "Zm9veA==") << "most lights, the first of them";
  EXPECT_FALSE(json["rows"][2].contains("thumbnail"));
  const auto file = std::filesystem::path(testing::TempDir()) / "bench_picture_rows.json";
  ASSERT_TRUE(write_file_atomically(file, json.dump()));
  const auto again = read_bench_rows(file);
  ASSERT_TRUE(again) << again.error().text();
  Figures figures(false);
  EXPECT_NE(bench_html(*again, "t", figures).find("data:image/png;base64,Zm9veA=="), std::string::npos);
  ASSERT_EQ(figures.files().size(), 1u);
  EXPECT_EQ(figures.files()[0], std::pair(std::string("01-street-b.png"), std::string("foox")));
  for (BenchRow& row : run.rows) row.thumbnail.clear();
  EXPECT_NE(tables_html(run, "t").find("There is no picture of the scene"), std::string::npos);
  std::filesystem::remove(file);
}

TEST(BenchHtml, FiguresAreFilesToo) {
  ASSERT_TRUE(has_gnuplot()) << "the package gnuplot-nox is missing: ./run install";
  Figures figures(true);
  const std::string html = bench_html(run_of({row_of(4, 10), row_of(16, 20)}), "t", figures);
  std::vector<std::string> names;
  for (const auto& [name, bytes] : figures.files()) {
    names.push_back(name);
    EXPECT_NE(html.find(base64(std::as_bytes(std::span(bytes)))), std::string::npos) << name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{
                       "01-street-b.png", "02-time-of-a-frame.svg", "03-lights-in-the-list-of-a-pixel.svg",
                       "04-listed-lights-that-contribute-nothing.svg", "05-memory-of-the-device-at-its-peak.svg",
                       "06-time-of-the-passes.svg", "07-shares-of-the-passes.svg"}));
}

// Passes are timed one by one, each alone: their sum is another quantity than the frame's time.
TEST(BenchHtml, FramesAndPassesShareNoTable) {
  const std::string html = tables_html(run_of({row_of(4, 10), row_of(16, 20)}), "t");
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
  const std::string one = tables_html(run_of({row_of(4, 10), row_of(16, 20)}), "t");
  const std::string two = tables_html(run_of({row_of(4, 10), gpu}), "t");
  const auto count = [](const std::string& text, std::string_view part) {
    size_t n = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count(one, "<h3>Frames"), 1u);
  EXPECT_EQ(count(two, "<h3>Frames"), 2u);
  EXPECT_NE(two.find("Rows of 2 devices"), std::string::npos);
  EXPECT_EQ(one.find("Rows of"), std::string::npos);
}

TEST(BenchHtml, ShowsWhatIsWrongAndWhatIsLeftOut) {
  BenchRow wrong = row_of(4, 10), left = row_of(16, 0), failed = row_of(64, 0);
  wrong.picture.differing = 12345;
  wrong.remarks = {"3 lights are LOST"};
  left.frame.ms.clear(), left.left_out = "the suite limits it";
  failed.frame.ms.clear(), failed.error = "out of memory";
  const std::string html = tables_html(run_of({wrong, left, failed}), "t");
  EXPECT_NE(html.find("<td class=\"bad\">12345</td>"), std::string::npos);
  EXPECT_NE(html.find("the suite limits it"), std::string::npos);
  EXPECT_NE(html.find("out of memory"), std::string::npos);
  EXPECT_NE(html.find("3 lights are LOST"), std::string::npos);
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
}  // namespace candela::report_bench
