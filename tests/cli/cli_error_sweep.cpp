#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

TEST(ErrorSweep, MeasuresWritesAndServesBudgets) {
  const TestFolder folder;
  const Ended ended = candela({"bench", "street", "--lights", "16", "--size", "48x32", "--error", "--techniques", "clustered", "--min-runs", "3", "--max-runs",
                               "3", "--warm-up-s", "0.001", "--reference-spp", "2", "--json", folder / "e.json", "--report", folder / "report", "--quiet"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("below 0.01 against direct-unshadowed"), std::string::npos) << ended.out;
  const Json json = Json::parse(bytes_of(folder / "e.json"));
  size_t whole = 0, exact_rungs = 0;
  for (const Json& row : json["rows"]) {
    whole += row["suite"] == "whole";
    ASSERT_EQ(row["errors"].size(), 4u) << row;
    for (const Json& error : row["errors"]) {
      EXPECT_TRUE(error["metrics"].contains("relmse")) << error;
      EXPECT_EQ(error["hdr_flip_exposures"], json["rows"][0]["errors"][0]["hdr_flip_exposures"]);
      EXPECT_EQ(error.contains("noise_floor"), error["reference"] != "exact");
    }
    // The exact end of each ladder is the exact picture itself, bit for bit.
    if (row["suite"] == "knob lights.floor_lux" && row["settings"] == "lights.floor_lux=0") {
      EXPECT_EQ(row["errors"][0]["metrics"]["differing"], 0);
      ++exact_rungs;
    }
    if (row["suite"] == "knob resolve.samples" && row["settings"] == "resolve.samples=1") {
      EXPECT_GT(row["errors"][0]["metrics"]["rmse"], 0);
    }
  }
  EXPECT_EQ(whole, 4u);
  EXPECT_EQ(exact_rungs, 1u);
  EXPECT_NE(bytes_of(folder / "report/index.html").find("Error against time"), std::string::npos);

  const auto render = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"render", scene("spheres"), "-o", folder / "a.exr", "--sweep", folder / "e.json", "--size", "48x32", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return candela(words);
  };
  const Ended chosen = render({"--error-budget", "relMSE=1e30"});
  ASSERT_EQ(chosen.code, 0) << chosen.err;
  EXPECT_NE(chosen.err.find("chosen: clustered"), std::string::npos) << chosen.err;
  EXPECT_EQ(render({"--time-budget", "1e9"}).code, 0);
  const Ended exact = render({"--error-budget", "relmse=0", "--error-reference", "exact"});
  ASSERT_EQ(exact.code, 0) << exact.err;
  EXPECT_EQ(Json::parse(exact.out)["job"]["quality"], "exact");
  for (const auto& more : std::vector<std::vector<std::string>>{{"--time-budget", "1e-9"},
                                                                {"--error-budget", "psnr=3"},
                                                                {"--error-budget", "relmse=1", "--quality", "draft"},
                                                                {"--error-budget", "relmse=1", "--error-reference", "best"},
                                                                {"--error-budget", "relmse=1", "--time-budget", "3"},
                                                                {}})
    EXPECT_EQ(render(more).code, 2) << (more.empty() ? "" : more[0]);
  EXPECT_EQ(candela({"render", scene("spheres"), "-o", folder / "a.exr", "--sweep", folder / "e.json", "--size", "64x64", "--error-budget", "relmse=1"}).code, 3);
}

TEST(ErrorSweep, UsageErrors) {
  for (const auto& more : std::vector<std::vector<std::string>>{{"street", "--error", "--quality", "high"},
                                                                {"street", "--reference-spp", "4"},
                                                                {"--suite", "exactness", "--error"},
                                                                {"street", "--error", "--hdr-flip", "1,2"}}) {
    std::vector<std::string> words = {"bench"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(candela(words).code, 2) << more.back();
  }
}

}  // namespace
}  // namespace candela::test
