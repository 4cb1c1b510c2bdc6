#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

std::string made_street(const TestFolder& folder) {
  EXPECT_EQ(candela({"make-scene", "street", "--lights", "16", "-o", folder / "street.glb"}).code, 0);
  return folder / "street.glb";
}

TEST(ErrorSweep, MeasuresWritesAndServesBudgets) {
  const TestFolder folder;
  const std::string street = made_street(folder);
  const Ended ended = candela({"bench",
                               street,
                               "--size",
                               "48x32",
                               "--error",
                               "--effects",
                               "occlusion",
                               "--techniques",
                               "clustered",
                               "--min-runs",
                               "3",
                               "--max-runs",
                               "3",
                               "--warm-up-s",
                               "0.001",
                               "--reference-spp",
                               "2",
                               "--json",
                               folder / "e.json",
                               "--report",
                               folder / "report",
                               "--quiet"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("relmse below 0.1 against direct:"), std::string::npos) << ended.out;
  EXPECT_EQ(ended.out.find("relmse below 0.1 against direct-unshadowed"), std::string::npos)
      << "judged by the reference that holds what the frame draws";
  const Json json = Json::parse(bytes_of(folder / "e.json"));
  size_t whole = 0, of_time = 0, measured_whole = 0;
  bool one_sample = false;
  for (const Json& row : json["rows"]) {
    measured_whole += row["suite"] == "whole";
    whole += row["suite"] == "whole";
    for (const Json& same : row.value("same_work", Json::array())) whole += same["suite"] == "whole";
    EXPECT_EQ(row["views"], 6);
    ASSERT_EQ(row["errors"].size(), 4u) << row;
    EXPECT_LE(row["gpu_ms"]["ci95"][0], row["gpu_ms"]["median"]);
    EXPECT_GE(row["gpu_ms"]["ci95"][1], row["gpu_ms"]["median"]);
    EXPECT_GT(row["memory"]["frame_bytes"], 0);
    for (const Json& error : row["errors"]) {
      EXPECT_TRUE(error["metrics"].contains("relmse")) << error;
      EXPECT_EQ(error["hdr_flip_exposures"], json["rows"][0]["errors"][0]["hdr_flip_exposures"]);
      EXPECT_EQ(error.contains("noise_floor"), error["reference"] != "exact");
      ASSERT_EQ(error["views"].size(), 6u);
      double sum = 0;
      for (const Json& view : error["views"]) sum += view["metrics"]["relmse"].get<double>();
      EXPECT_NEAR(error["metrics"]["relmse"].get<double>(), sum / 6, 1e-9 + sum * 1e-9);
      EXPECT_EQ(error.value("spp", 0), error["reference"] == "exact" ? 0 : 2);
    }
    // The exact end of each ladder is the exact picture itself, bit for bit; and so is what knobs of time give.
    const bool exact_end = row["suite"] == "whole" && row["quality"] == "exact";
    const bool time_only = row["suite"] != "whole" && row["knobs"][0]["trades"] == "time";
    if (exact_end || time_only) {
      EXPECT_EQ(row["errors"][0]["metrics"]["differing"], 0) << row["settings"];
    }
    if (exact_end) {
      EXPECT_GE(row["knobs"].size(), 5u);
    }
    of_time += time_only;
    if (row["settings"] == "resolve.samples=1 supersample.n=1") {
      one_sample = true;
      EXPECT_GT(row["errors"][0]["metrics"]["rmse"], 0);
    }
  }
  EXPECT_TRUE(one_sample);
  EXPECT_EQ(whole, 4u);
  EXPECT_EQ(measured_whole, 4u) << "every quality samples textures or pixels in another way";
  EXPECT_NE(json["unswept_knobs"].dump().find("lights.mask"), std::string::npos) << json["unswept_knobs"];
  EXPECT_GE(of_time, 8u);
  const Json& findings = json["error_findings"][0];
  EXPECT_EQ(findings["defects"].size(), 0u);
  EXPECT_EQ(findings["noise"].size(), 3u);
  EXPECT_EQ(findings["total"].size(), 12u) << "four qualities against three references";
  for (const Json& study : findings["knobs"]) EXPECT_GT(study["values"].back()["passes_ms"], 0) << study["knob"];
  EXPECT_NE(bytes_of(folder / "report/index.html").find("Error against time"), std::string::npos);

  const auto render = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"render",          street,   "-o",    folder / "a.exr", "--sweep",
                                      folder / "e.json", "--size", "48x32", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return candela(words);
  };
  const Ended chosen = render({"--error-budget", "relMSE=1e30"});
  ASSERT_EQ(chosen.code, 0) << chosen.err;
  EXPECT_NE(chosen.err.find("chosen: clustered"), std::string::npos) << chosen.err;
  EXPECT_NE(chosen.err.find("95 % CI"), std::string::npos) << chosen.err;
  EXPECT_EQ(render({"--time-budget", "1e9"}).code, 0);
  const Ended exact = render({"--error-budget", "relmse=0", "--error-reference", "exact"});
  ASSERT_EQ(exact.code, 0) << exact.err;
  // Which of the settings that give the exact picture is chosen is a matter of time.
  ASSERT_EQ(candela({"render", street, "-o", folder / "exact.exr", "--size", "48x32", "--quality", "exact"}).code, 0);
  EXPECT_EQ(candela({"compare", folder / "a.exr", folder / "exact.exr", "--limit", "differing=0"}).code, 0);
  for (const auto& more :
       std::vector<std::vector<std::string>>{{"--time-budget", "1e-9"},
                                             {"--error-budget", "psnr=3"},
                                             {"--error-budget", "relmse=1", "--quality", "draft"},
                                             {"--error-budget", "relmse=1", "--error-reference", "best"},
                                             {"--error-budget", "relmse=1", "--time-budget", "3"},
                                             {}})
    EXPECT_EQ(render(more).code, 2) << (more.empty() ? "" : more[0]);
  const auto refused = [&](const std::string& of, const std::string& size, const std::string& sweep) {
    const Ended end =
        candela({"render", of, "-o", folder / "a.exr", "--sweep", sweep, "--size", size, "--time-budget", "1e9"});
    EXPECT_EQ(end.code, 3) << end.err;
    return end.err;
  };
  EXPECT_NE(refused(street, "64x64", folder / "e.json").find("not measured at 64x64 but at 48x32"), std::string::npos);
  EXPECT_NE(refused(scene("spheres"), "48x32", folder / "e.json")
                .find("neither times nor errors carry over from scene to scene"),
            std::string::npos);
  Json elsewhere = json;
  for (Json& row : elsewhere["rows"]) row["device"]["name"] = "another device";
  std::ofstream(folder / "elsewhere.json") << elsewhere;
  EXPECT_NE(refused(street, "48x32", folder / "elsewhere.json").find("but on another device"), std::string::npos);
}

// Samples of references are kept: what is there is not traced again, fewer go on, and none decide a run that asks for
// less.
TEST(ErrorSweep, ReferencesAreKept) {
  const TestFolder folder;
  const std::string street = made_street(folder);
  const auto bench = [&](const char* spp) {
    const Ended ended = candela({"bench", street,         "--size",         "32x24",           "--error", "--effects",
                                 "none",  "--techniques", "brute-force",    "--min-runs",      "1",       "--max-runs",
                                 "1",     "--warm-up-s",  "0.001",          "--reference-spp", spp,       "--views",
                                 "1",     "--json",       folder / "e.json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    Json errors = Json::array();
    for (const Json& row : Json::parse(bytes_of(folder / "e.json"))["rows"]) errors.push_back(row["errors"]);
    return std::pair(errors, ended.err);
  };
  const char* before = std::getenv("CANDELA_CACHE_DIR");
  const std::string cache = before ? before : "";
  setenv("CANDELA_CACHE_DIR", (folder / "cache").c_str(), 1);
  const auto two = bench("2");
  EXPECT_NE(two.second.find("reference path: 2 samples a pixel (0 of them kept before)"), std::string::npos)
      << two.second;
  EXPECT_EQ(files_in(folder.path() / "cache/references").size(), 3u);
  const auto again = bench("2");
  EXPECT_NE(again.second.find("reference path: 2 samples a pixel (2 of them kept before)"), std::string::npos)
      << again.second;
  EXPECT_EQ(again.first, two.first);
  const auto four = bench("4");
  EXPECT_NE(four.second.find("reference direct: 4 samples a pixel (2 of them kept before)"), std::string::npos)
      << four.second;
  EXPECT_EQ(bench("2").first, two.first);
  EXPECT_NE(bench("4").second.find("4 samples a pixel (4 of them kept before)"), std::string::npos)
      << "two must not have taken their place";
  if (before)
    setenv("CANDELA_CACHE_DIR", cache.c_str(), 1);
  else
    unsetenv("CANDELA_CACHE_DIR");
}

std::vector<std::string> budgeted(const std::string& file, const char* seconds) {
  return {"bench", "unlit-box", "--size", "24x16", "--error", "--budget-s", seconds, "--json", file};
}

// A budget holds for all of it: what it leaves out is said, rows come in the order of use, none is without a time.
TEST(ErrorSweep, ABudgetHoldsForAllOfIt) {
  const TestFolder folder;
  const Ended ended = candela(budgeted(folder / "e.json", "6"));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.err.substr(0, ended.err.find('\n')).find("error against time in 6 s"), std::string::npos)
      << ended.err;
  const Json json = Json::parse(bytes_of(folder / "e.json"));
  ASSERT_GE(json["rows"].size(), 1u);
  const Json& first = json["rows"][0];
  EXPECT_EQ(first["technique"], "clustered");
  EXPECT_EQ(first["quality"], "high");
  std::set<std::string> works;
  for (const Json& row : json["rows"]) {
    EXPECT_GE(row["gpu_ms"]["count"], 1) << row["settings"];
    EXPECT_EQ(row["rounds"].size(), row["gpu_ms"]["count"]);
    EXPECT_EQ(row["truth"], "direct");
    EXPECT_TRUE(works.insert(row["plan_hash"].get<std::string>() + row["knob_hash"].get<std::string>()).second);
  }
  EXPECT_EQ(json["error_findings"][0]["truth"], "direct");
  const Ended too_short = candela(budgeted(folder / "none.json", "0.001"));
  EXPECT_EQ(too_short.code, 2);
  EXPECT_NE(too_short.err.find("nothing was measured"), std::string::npos) << too_short.err;
  EXPECT_NE(too_short.err.find("give at least"), std::string::npos) << too_short.err;
}

// Rows are written as they come: a killed run leaves them, reports are made of them, and a later run goes on.
TEST(ErrorSweep, AKilledRunLeavesItsRows) {
  const TestFolder folder;
  const std::string file = folder / "e.json";
  ASSERT_TRUE(candela_killed_once_written(budgeted(file, "600"), file, SIGKILL));
  const Json left = Json::parse(bytes_of(file));
  ASSERT_GE(left["rows"].size(), 1u);
  for (const Json& row : left["rows"]) EXPECT_GE(row["gpu_ms"]["count"], 1);
  EXPECT_EQ(candela({"bench", "--from", file, "--report", folder / "report"}).code, 0);
  std::vector<std::string> again = budgeted(file, "5");
  again.emplace_back("--resume");
  const Ended resumed = candela(again);
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_NE(resumed.err.find("clustered, quality high: kept from before"), std::string::npos) << resumed.err;
  const Json whole = Json::parse(bytes_of(file));
  EXPECT_EQ(whole["rows"][0]["gpu_ms"]["samples"], left["rows"][0]["gpu_ms"]["samples"]);
  EXPECT_GT(whole["rows"].size(), left["rows"].size()) << "knobs a step from high come after what was kept";
  // What a run does not come to stays all the same.
  std::vector<std::string> none = budgeted(file, "0.001");
  none.emplace_back("--resume");
  EXPECT_EQ(candela(none).code, 0);
  EXPECT_EQ(Json::parse(bytes_of(file))["rows"].size(), whole["rows"].size());
  // Another scene of that name is not gone on with.
  Json changed = whole;
  for (Json& row : changed["rows"]) row["scene_content"] = "00000000000000000000000000000000";
  std::ofstream(file) << changed;
  const Ended refused = candela(again);
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_NE(refused.err.find("has changed since the rows"), std::string::npos) << refused.err;
  EXPECT_EQ(candela({"bench", "unlit-box", "--error", "--resume"}).code, 2) << "no file to go on from";
}

TEST(ErrorSweep, KnobsSayWhatTheyTrade) {
  const Ended ended = candela({"list", "knobs", "--json"});
  ASSERT_EQ(ended.code, 0);
  for (const Json& knob : Json::parse(ended.out)) {
    EXPECT_TRUE(knob["kind"] == "error" || knob["kind"] == "time" || knob["kind"] == "look") << knob;
    EXPECT_EQ(knob["swept"].size() > 1, knob["kind"] != "look") << knob;
  }
}

TEST(ErrorSweep, UsageErrors) {
  for (const auto& more : std::vector<std::vector<std::string>>{{"street", "--error", "--quality", "high"},
                                                                {"street", "--reference-spp", "4"},
                                                                {"street", "--views", "3"},
                                                                {"--suite", "exactness", "--error"},
                                                                {"street", "--error", "--hdr-flip", "1,2"}}) {
    std::vector<std::string> words = {"bench"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(candela(words).code, 2) << more.back();
  }
}

}  // namespace
}  // namespace candela::test
