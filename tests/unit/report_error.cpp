#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/files.h"
#include "bench/error_truth.h"
#include "report/bench_report.h"
#include "report/bench_rows.h"
#include "report/error_report.h"
#include "report/scatter.h"

namespace candela {
namespace {

BenchRow row_of(const std::string& quality, double ms, double error) {
  BenchRow row;
  row.suite = "whole", row.scene = "a <scene>", row.technique = "clustered", row.quality = quality, row.output = "exr";
  row.width_px = 64, row.height_px = 32, row.device = "a device", row.device_type = "gpu", row.job = "{}";
  row.gpu = {"gpu", std::vector<double>(6, ms)}, row.frame = {"frame", std::vector<double>(6, ms)};
  row.errors = {{.reference = exact_reference, .metrics = {{"relmse", error}, {"rmse", error}}},
                {.reference = open_reference_name,
                 .metrics = {{"relmse", error + 0.001}, {"hdr-flip", 0.1}},
                 .noise = NoiseFloor{0.001, 0.0005},
                 .exposures = ExposureRange{-4, 4, 9},
                 .spp = 16},
                {.reference = "path", .note = "could not be traced"}};
  row.knobs = {{"lights.floor_lux", "0.1", "error", {"shade_forward"}}};
  row.memory = {{"frame_bytes", 3 << 20}, {"device_peak_bytes", 7 << 20}};
  row.views = 6, row.run = 1;
  row.errors[1].views = std::vector<ViewError>(6, {{{"relmse", error + 0.001}}, NoiseFloor{0.001, 0.0005, 1e-5}});
  row.same_work = {{"whole", "forward-plus", quality, "", "{}", row.knobs, row.errors[0]}};
  row.strip = {std::byte('p'), std::byte('n'), std::byte('g')};
  return row;
}
BenchRun run() { return {{row_of("draft", 2, 0.05), row_of("high", 9, 0), row_of("normal", 10, 0.01)}, {}, 1}; }

TEST(ErrorRows, ComeBackFromJson) {
  const auto file = std::filesystem::path(testing::TempDir()) / "error_rows.json";
  ASSERT_TRUE(write_file_atomically(file, bench_json(run()).dump()));
  const auto again = read_bench_rows(file);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(bench_json(*again).dump(), bench_json(run()).dump());
  EXPECT_EQ(again->rows[0].errors[1].exposures, (ExposureRange{-4, 4, 9}));
  EXPECT_EQ(again->rows[0].errors[2].note, "could not be traced");
  EXPECT_EQ(again->rows[0].errors[1].spp, 16u);
  EXPECT_EQ(again->rows[0].errors[1].views[1].metrics.at("relmse"), 0.05 + 0.001);
  EXPECT_EQ(again->rows[0].errors[1].views[0].noise->relmse_sd, 1e-5);
  EXPECT_EQ(again->rows[0].same_work[0].technique, "forward-plus");
  EXPECT_EQ(again->rows[0].same_work[0].exact->metrics.at("relmse"), 0.05);
  EXPECT_EQ(again->rows[0].views, 6);
  EXPECT_EQ(again->rows[0].run, 1);
  EXPECT_EQ(again->rows[0].knobs[0].passes, std::vector<std::string>{"shade_forward"});
  std::filesystem::remove(file);
}

TEST(ErrorRows, FindingsSayFrontsAndSentences) {
  const auto json = bench_json(run());
  const auto& findings = json["error_findings"];
  ASSERT_EQ(findings.size(), 1u);
  bool said = false;
  for (const auto& c : findings[0]["cheapest"])
    if (c["reference"] == open_reference_name && c["below"] == 0.01) {
      EXPECT_EQ(c["setting"], "clustered, quality high");
      said = true;
    }
  EXPECT_TRUE(said);
  for (const auto& front : findings[0]["fronts"])
    if (front["reference"] == open_reference_name) {
      EXPECT_EQ(front["points"].size(), 2u);  // normal is slower and worse than high
    }
  EXPECT_FALSE(bench_json({}).contains("error_findings"));
}

TEST(ErrorRows, CsvHasAColumnForEachError) {
  const std::string csv = bench_csv(run());
  const std::string head = csv.substr(0, csv.find("\r\n"));
  for (const char* column : {"error.exact.relmse", "error.direct-unshadowed.hdr-flip", "noise.direct-unshadowed.relmse",
                             "gpu_ci95_low_ms", "gpu_ci95_high_ms"})
    EXPECT_NE(head.find(column), std::string::npos) << column;
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  const std::string second = csv.substr(head.size() + 2, csv.find("\r\n", head.size() + 2) - head.size() - 2);
  EXPECT_EQ(commas(second), commas(head));
}

TEST(ErrorReport, HasFrontsNoiseSentencesAndStrips) {
  FigureFiles figures;
  const std::string html = bench_html(run(), "t", false, &figures);
  for (const char* part :
       {"Error against time: a &lt;scene&gt;", "noise of the reference", "the cheapest setting is",
        "Reference, result, FLIP", "cG5n", "95 % CI", "sampling error", "3.00", "7.00", "16 samples a pixel"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_EQ(html.find("a <scene>"), std::string::npos);
  FigureFiles none;
  EXPECT_EQ(error_html({}, none), "");
  EXPECT_TRUE(none.files.empty());
  // Each figure of the page is a file too, in the page's order.
  ASSERT_FALSE(figures.files.empty());
  EXPECT_TRUE(figures.files.front().first.starts_with("01-relmse-against-")) << figures.files.front().first;
  size_t at = 0;
  for (const auto& [name, svg] : figures.files) {
    EXPECT_TRUE(svg.starts_with("<svg ")) << name;
    at = html.find(svg, at);
    ASSERT_NE(at, std::string::npos) << name;
  }
}

TEST(Scatter, TicksAtOneTwoAndFive) {
  Scatter s{.title = "t", .points = {{"a", 8, 3e-5, 0, false, 7.5, 9}, {"b", 47, 0.3, 0, true}}, .floor_y = 1e-5};
  const std::string svg = scatter_svg(s);
  for (const char* tick : {">5<", ">10<", ">20<", ">50<", ">1e-05<", ">0.01<", ">1<"}) {
    if (std::string_view(tick) == ">1<")
      EXPECT_EQ(svg.find(tick), std::string::npos) << "0.3 needs no more than 0.5";
    else
      EXPECT_NE(svg.find(tick), std::string::npos) << tick << svg;
  }
  EXPECT_EQ(svg.find(">2e-05<"), std::string::npos) << "many decades have no room between them";
  // 7.5 to 9 of 5 to 50 over 720 from 80.
  EXPECT_NE(svg.find("M206.8 "), std::string::npos) << svg;
  EXPECT_NE(svg.find("H263.8"), std::string::npos) << svg;
  const std::string flat = scatter_svg({.title = "t", .points = {{"a", 3, 3, 0, false}}});
  EXPECT_EQ(flat.find("nan"), std::string::npos);
}

TEST(Scatter, RingsAndBarsSayWhatIsNotSure) {
  Scatter s{.title = "t",
            .points = {{"a", 1, 0.1, 0, false, 0, 0, 0.05, 0.2}, {"b", 2, 0.2, 0, false, 0, 0, 0, 0, true}}};
  const std::string svg = scatter_svg(s);
  EXPECT_NE(svg.find("r=\"5\" fill=\"#fff\" stroke="), std::string::npos) << svg;
  EXPECT_EQ(svg.find("opacity=\"0.3\""), std::string::npos) << "nothing is dimmed";
  // From 0.05 to 0.2 of 0.05 to 0.5 over 380 up from 414, with ends of four to each side.
  EXPECT_NE(svg.find("M76.0 414.0H84.0M80.0 414.0V185.2"), std::string::npos) << svg;
}

TEST(Scatter, DrawsALaw) {
  Scatter s{.title = "t",
            .points = {{"a", 1, 1, 0, false}, {"b", 10, 10, 0, false}},
            .stairs = false,
            .curve = {{1, 1}, {10, 10}}};
  EXPECT_NE(scatter_svg(s).find("M80.0 414.0L800.0 34.0"), std::string::npos) << scatter_svg(s);
}

TEST(Scatter, PutsPointsOnLogarithmicAxes) {
  Scatter s{.title = "t",
            .points = {{"a", 1, 0.01, 0, false}, {"b & c", 10, 0.001, 0, true}, {"zero", 100, 0, 1, false}},
            .groups = {"g", "h"}};
  const std::string svg = scatter_svg(s);
  // x from 1 to 100 over 720 from 80; y from 1e-3 to 1e-2 over 380 down to 414.
  EXPECT_NE(svg.find("cx=\"80.0\" cy=\"34.0\" r=\"6\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("cx=\"440.0\" cy=\"414.0\" r=\"4\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("cx=\"800.0\" cy=\"414.0\" r=\"6\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("no difference at all"), std::string::npos);
  EXPECT_NE(svg.find("b &amp; c"), std::string::npos);
  EXPECT_EQ(scatter_svg({}), "");
}

}  // namespace
}  // namespace candela
