#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "program.h"

namespace candela::test::cli_bench {
namespace {

using Json = nlohmann::json;

Ended bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "bench");
  arguments.push_back("--quiet");
  return candela(std::move(arguments));
}

// Two light counts, with and without culling, as small and short as it gets.
std::vector<std::string> small(std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"animated",
                                        "--lights",
                                        "2,5",
                                        "--size",
                                        "40x24",
                                        "--samples",
                                        "1",
                                        "--techniques",
                                        "brute-force",
                                        "--set",
                                        "cull.enabled=0,1",
                                        "--min-runs",
                                        "3",
                                        "--max-runs",
                                        "3",
                                        "--warm-up-s",
                                        "0.001"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void write_json(const std::string& file, const Json& j) { std::ofstream(file) << j.dump(); }

TEST(Bench, MeasuresEveryConfigurationAndWritesItsReport) {
  const TestFolder folder;
  const Ended ended =
      bench(small({"--report", folder / "report", "--json", folder / "r.json", "--csv", folder / "r.csv"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("brute-force cull.enabled=0, 40x24, 1 sample"), std::string::npos) << ended.out;
  const Json json = Json::parse(bytes_of(folder / "r.json"));
  ASSERT_EQ(json["rows"].size(), 4u);
  for (const Json& row : json["rows"]) {
    EXPECT_EQ(row["frame_ms"]["count"], 3);
    EXPECT_EQ(row["frame_ms"]["samples"].size(), 3u);
    EXPECT_EQ(row["gpu_ms"]["count"], 3);
    EXPECT_EQ(row["passes_ms"]["shade_forward"]["count"], 3);
    EXPECT_EQ(row["cpu_ms"]["wait"]["count"], 3);
    EXPECT_GT(row["memory"]["device_peak_bytes"], 0);
    EXPECT_EQ(row["picture"]["reference"], "brute-force");
    EXPECT_EQ(row["picture"]["differing"], 0);
    EXPECT_EQ(row["plan_hash"].get<std::string>().size(), 32u);
    EXPECT_FALSE(row["device"]["name"].get<std::string>().empty());
    EXPECT_EQ(row["job"]["scene"], "animated") << "no path of this machine";
  }
  EXPECT_EQ(json["rows"][0]["lights_wanted"], 2);
  EXPECT_GT(json["rows"][2]["lights"], json["rows"][0]["lights"]);
  EXPECT_NE(json["rows"][0]["knob_hash"], json["rows"][1]["knob_hash"]);
  EXPECT_EQ(bytes_of(folder / "report/rows.json"), bytes_of(folder / "r.json"));
  EXPECT_EQ(bytes_of(folder / "report/rows.csv"), bytes_of(folder / "r.csv"));
  const std::string html = bytes_of(folder / "report/index.html");
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos) << "a thumbnail";
  EXPECT_NE(html.find("shade_forward"), std::string::npos);
  // The report again from the rows that were kept.
  const Ended again = bench({"--from", folder / "r.json", "--report", folder / "again"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(Json::parse(bytes_of(folder / "again/rows.json"))["rows"], json["rows"]);
}

TEST(Bench, ComparesByExitCode) {
  const TestFolder folder;
  ASSERT_EQ(bench(small({"--json", folder / "old.json"})).code, 0);
  Json rows = Json::parse(bytes_of(folder / "old.json"));
  // Times that no other work on this machine has touched.
  for (Json& row : rows["rows"]) row["frame_ms"]["samples"] = {10.0, 10.1, 10.2};
  write_json(folder / "old.json", rows);
  const Ended same = bench({"--compare", folder / "old.json", folder / "old.json"});
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  for (Json& sample : rows["rows"][1]["frame_ms"]["samples"]) sample = sample.get<double>() * 10 + 1000;
  write_json(folder / "new.json", rows);
  const Ended slower = bench({"--compare", folder / "old.json", folder / "new.json", "--json", folder / "c.json"});
  EXPECT_EQ(slower.code, 1) << slower.err;
  EXPECT_NE(slower.out.find("slower"), std::string::npos);
  EXPECT_EQ(Json::parse(bytes_of(folder / "c.json"))["slower"], true);
  const Ended faster = bench({"--compare", folder / "new.json", folder / "old.json"});
  EXPECT_EQ(faster.code, 0) << faster.out;
  EXPECT_NE(faster.out.find("faster"), std::string::npos);
  rows["rows"][0]["device"]["name"] = "Some GPU";
  write_json(folder / "gpu.json", rows);
  const Ended refused = bench({"--compare", folder / "old.json", folder / "gpu.json"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("Some GPU"), std::string::npos) << refused.err;
  EXPECT_EQ(bench({"--compare", folder / "old.json", folder / "absent.json"}).code, 3);
}

// 0 only where it is sure that nothing is slower by more than that.
TEST(Bench, AGateOnTime) {
  const TestFolder folder;
  ASSERT_EQ(bench({"unlit-box", "--size", "8x8", "--techniques", "clustered", "--min-runs", "6", "--max-runs", "6",
                   "--warm-up-s", "0.001", "--json", folder / "a.json"})
                .code,
            0);
  const Json measured = Json::parse(bytes_of(folder / "a.json"));
  const auto write = [&](const std::string& name, double factor, const std::string& device = {}) {
    Json run = measured;
    const std::vector<double> ms = {10, 10.1, 9.9, 10.2, 9.8, 10};
    for (Json& row : run["rows"]) {
      row["frame_ms"]["samples"] = Json::array();
      for (const double m : ms) row["frame_ms"]["samples"].push_back(m * factor);
      if (!device.empty()) row["device"]["name"] = device;
    }
    std::filesystem::create_directories(std::filesystem::path(folder / name).parent_path());
    std::ofstream(folder / name) << run;
  };
  write("old.json", 1), write("same.json", 1.001), write("slower.json", 1.2);
  write("baselines/a.json", 0.5, "another device"), write("baselines/b.json", 1);
  write("others/a.json", 0.5, "another device");
  const auto gate = [&](const std::string& old, const std::string& now, const char* percent) {
    return bench({"--compare", folder / old, folder / now, "--no-slower-than", percent});
  };
  EXPECT_EQ(gate("old.json", "same.json", "5").code, 0);
  const Ended slower = gate("old.json", "slower.json", "5");
  EXPECT_EQ(slower.code, 1);
  EXPECT_NE(slower.out.find("1 of 1 rows are slower by more than 5 %"), std::string::npos) << slower.out;
  EXPECT_EQ(gate("old.json", "slower.json", "30").code, 0);
  const Ended unclear = gate("old.json", "same.json", "0.5");
  EXPECT_EQ(unclear.code, 1);
  EXPECT_NE(unclear.out.find("of 1 it cannot be told"), std::string::npos) << unclear.out;
  EXPECT_EQ(gate("baselines", "same.json", "5").code, 0) << "the file of the same device";
  Json failed = Json::parse(bytes_of(folder / "same.json"));
  failed["rows"][0]["settings"] = "lights.mask=0";
  write_json(folder / "renamed.json", failed);
  EXPECT_EQ(gate("old.json", "renamed.json", "5").code, 1) << "of what is not there any more nothing is shown";
  const Ended none = gate("others", "same.json", "5");
  EXPECT_EQ(none.code, 3);
  EXPECT_NE(none.err.find("another device"), std::string::npos) << none.err;
  EXPECT_EQ(bench({"unlit-box", "--no-slower-than", "5"}).code, 2);
}

TEST(Bench, ReadsSuitesStrictly) {
  const TestFolder folder;
  const auto suite = [&](const char* text, const std::string& assets = ".") {
    std::ofstream(folder / "s.json") << text;
    return bench({folder / "s.json", "--json", "-", "--assets", assets});
  };
  const Ended unknown = suite(R"({"scenes": ["spheres"], "tehniques": ["brute-force"]})");
  EXPECT_EQ(unknown.code, 3);
  EXPECT_NE(unknown.err.find("techniques"), std::string::npos) << unknown.err;
  const Ended technique = suite(R"({"scenes": ["spheres"], "techniques": ["brut-force"]})");
  EXPECT_EQ(technique.code, 2);
  EXPECT_NE(technique.err.find("did you mean 'brute-force'"), std::string::npos) << technique.err;
  const char* tiny = R"({"name": "tiny", "scenes": [{"scene": "animated", "lights": [2, 9]}, "assets:none.glb"],
      "techniques": ["brute-force"], "sizes": "40x24", "samples": 1, "min_runs": 1, "max_runs": 1, "warm_up_s": 0.001,
      "max_lights": {"brute-force": 4}})";
  const Ended without = suite(tiny, folder / "no-such-folder");
  ASSERT_EQ(without.code, 0) << "the whole folder is optional: " << without.err;
  EXPECT_NE(Json::parse(without.out)["rows"][2]["left_out"].dump().find("no folder of assets"), std::string::npos);
  const Ended measured = suite(tiny, folder / "");
  ASSERT_EQ(measured.code, 3) << "the folder is there and the asset is not: " << measured.err;
  const Json rows = Json::parse(measured.out)["rows"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["suite"], "tiny");
  EXPECT_EQ(rows[0]["frame_ms"]["count"], 1);
  EXPECT_EQ(rows[1]["left_out"], "the suite limits brute-force to 4 lights");
  EXPECT_EQ(rows[1]["frame_ms"]["count"], 0);
  EXPECT_FALSE(rows[2].value("error", Json()).is_null());
}

TEST(Bench, TakesTheTechniqueThatIsQuickestOnTheDeviceByItsName) {
  const TestFolder folder;
  std::ofstream(folder / "s.json") << R"({"scenes": ["unlit-box"], "techniques": ["auto"]})";
  for (const auto& [what, techniques, rows] : std::vector<std::tuple<std::string, std::string, size_t>>{
           {"unlit-box", "auto", 1}, {"unlit-box", "clustered,visibility,auto", 2}, {folder / "s.json", "", 1}}) {
    std::vector<std::string> words = {what, "--size",     "24x16", "--json",      "-",    "--min-runs",
                                      "1",  "--max-runs", "1",     "--warm-up-s", "0.001"};
    if (!techniques.empty()) words.insert(words.end(), {"--techniques", techniques});
    const Ended ended = bench(words);
    ASSERT_EQ(ended.code, 0) << ended.err;
    const Json json = Json::parse(ended.out);
    ASSERT_EQ(json["rows"].size(), rows) << techniques;
    for (const Json& row : json["rows"])
      EXPECT_TRUE(row["technique"] == "clustered" || row["technique"] == "visibility") << row["technique"];
  }
}

TEST(Bench, SaysWhenTimeOrMemoryRunOut) {
  const Ended late =
      bench({"animated",     "--lights",    "2,5",        "--size", "40x24",      "--samples",  "1",
             "--techniques", "brute-force", "--min-runs", "3",      "--max-runs", "9",          "--precision",
             "1e-9",         "--warm-up-s", "0.001",      "--json", "-",          "--budget-s", "0.000001"});
  ASSERT_EQ(late.code, 0) << late.err;
  Json json = Json::parse(late.out);
  EXPECT_NE(json["notes"].dump().find("time budget"), std::string::npos) << json["notes"];
  ASSERT_EQ(json["rows"].size(), 2u);
  for (const Json& row : json["rows"]) {
    EXPECT_EQ(row["frame_ms"]["count"], 3) << "the least number of runs";
    EXPECT_EQ(row["budget_hit"], true);
  }
  const Ended few = bench(small({"--json", "-", "--max-sessions", "1"}));
  ASSERT_EQ(few.code, 0) << few.err;
  json = Json::parse(few.out);
  EXPECT_EQ(json["rows"][0]["reopened"], false);
  EXPECT_EQ(json["rows"][3]["reopened"], true);
  EXPECT_EQ(json["rows"][3]["frame_ms"]["count"], 3);
}

TEST(Bench, ARunThatMeasuresNothingFails) {
  const TestFolder folder;
  std::ofstream(folder / "s.json") << R"({"scenes": ["assets:none.glb"], "techniques": ["brute-force"]})";
  const Ended nothing = bench({folder / "s.json", "--json", folder / "r.json", "--assets", folder / "absent"});
  EXPECT_EQ(nothing.code, 3);
  EXPECT_NE(nothing.err.find("nothing was measured"), std::string::npos) << nothing.err;
  EXPECT_EQ(Json::parse(bytes_of(folder / "r.json"))["rows"].size(), 1u);
}

TEST(Bench, UsageErrorsSayWhatIsMeant) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"spheres", "--size", "12"},
                                             {"spheres", "--samples", "a"},
                                             {"spheres", "--set", "cull.enabled"},
                                             {"spheres", "--set", "cull.enabld=1"},
                                             {"spheres", "--count", "3"},
                                             {"spheres", "--suite", "exactness"},
                                             {"--suite", "exactnes"},
                                             {"--suite", "stillness", "--lights", "4"},
                                             {"--suite", "stillness", "--only", "no such place"},
                                             {"--suite", "stillness", "--set", "local.samples=4,16"},
                                             {"spheres", "--times", "x"},
                                             {"spheres", "--output", "jpg"},
                                             {"--from", "x.json"}}) {
    const Ended ended = bench(arguments);
    EXPECT_EQ(ended.code, 2) << (arguments.empty() ? "" : arguments.back()) << ": " << ended.err;
    EXPECT_FALSE(ended.err.empty());
  }
}

TEST(Bench, ExactnessComparesEveryTechniqueWithTheReference) {
  const TestFolder folder;
  const Ended ended = bench({"--suite", "exactness", "--count", "2", "--size", "48x32", "--samples", "1", "--assets",
                             folder / "none", "--json", folder / "e.json"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  EXPECT_NE(ended.err.find("skipped assets:"), std::string::npos) << ended.err;
  EXPECT_NE(ended.out.find("0 pixels differ"), std::string::npos) << ended.out;
  const Json json = Json::parse(bytes_of(folder / "e.json"));
  EXPECT_EQ(json["differing_pixels"], 0);
  EXPECT_GE(json["pictures"], 2);
}

TEST(Bench, ExactnessFindsLightsThatAreLost) {
  const TestFolder folder;
  // A cap drops lights, as it does in other renderers: seed 2 has a field of 349.
  const Ended ended =
      bench({"--suite", "exactness", "--count", "1", "--seed", "2", "--size", "48x32", "--samples", "1", "--techniques",
             "forward-plus", "--set", "lights.cap=1", "--set", "lights.few=0", "--assets", folder / "none"});
  EXPECT_EQ(ended.code, 1) << ended.out << ended.err;
  EXPECT_EQ(ended.out.find("\n0 pixels differ"), std::string::npos);
  EXPECT_NE(ended.out.find("worst: make-scene light-field --seed 2"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("--technique forward-plus"), std::string::npos) << ended.out;
}

// Second differences of what arrives of a lamp's light, and how far it is from the truth.
std::pair<double, double> stillness_of_local_shadows(const std::string& places, const std::string& json) {
  const Ended ended = bench({"--suite", "stillness", "--only", "near-world", "--size", "96x54", "--quality", "high",
                             "--reference-spp", "16", "--set", "local.pixel_places=" + places, "--json", json});
  EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
  const Json report = Json::parse(bytes_of(json));
  for (const Json& row : report["rows"])
    if (row["layer"] == "shadow_local") {
      EXPECT_GT(row["pixels"], 1000);
      EXPECT_GT(row["truth_second_difference"], 0.005);
      return {row["second_difference"], row["error"]};
    }
  ADD_FAILURE() << "no row of shadow_local";
  return {};
}

TEST(Bench, StillnessFindsShadowsThatJumpFromPixelToPixel) {
  const TestFolder folder;
  const auto [jumps, jumps_error] = stillness_of_local_shadows("0", folder / "points.json");
  const auto [still, still_error] = stillness_of_local_shadows("9", folder / "pixels.json");
  EXPECT_LT(still, 0.6 * jumps);
  EXPECT_LT(still_error, 0.8 * jumps_error);
}

}  // namespace
}  // namespace candela::test::cli_bench
