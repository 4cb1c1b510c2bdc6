#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/files.h"
#include "bench/error_truth.h"
#include "report/bench_report.h"
#include "report/bench_rows.h"
#include "report/error_report.h"
#include "report/gnuplot.h"

namespace candela::report_error {
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
  ASSERT_TRUE(has_gnuplot()) << "the package gnuplot-nox is missing: ./run install";
  Figures figures(true);
  const std::string html = bench_html(run(), "t", figures);
  for (const char* part : {"Error against time: a &lt;scene&gt;", "the cheapest setting is", "Reference, result, FLIP",
                           "cG5n", "95 % CI", "sampling error", "3.00", "7.00", "16 samples a pixel"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_EQ(html.find("a <scene>"), std::string::npos);
  // Findings first: the sentence of the page's head stands before the section.
  EXPECT_LT(html.find("the cheapest setting is"), html.find("Error against time"));
  Figures none(true);
  EXPECT_EQ(error_html({}, none), "");
  EXPECT_TRUE(none.files().empty());
  ASSERT_FALSE(figures.files().empty());
  EXPECT_EQ(figures.files()[0].first, "01-relmse-against-direct-unshadowed.svg");
  EXPECT_NE(figures.files()[0].second.find("noise of the reference"), std::string::npos);
  EXPECT_NE(figures.files()[0].second.find("clustered, quality draft"), std::string::npos) << "a point of the front";
}

}  // namespace
}  // namespace candela::report_error
