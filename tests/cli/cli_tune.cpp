#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

TEST(Tune, WhatItNamesIsWhatRenderGives) {
  const TestFolder folder;
  const Ended ended =
      candela({"tune", scene("spheres"), "--size", "32x18", "--seconds", "12", "--device", "cpu", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err.find("tune, 32x18: at most 12 s"), 0u) << "the first line says what will be done";
  const Json report = Json::parse(ended.out);
  EXPECT_EQ(report["reference"]["name"], "direct");
  size_t measured = 0;
  std::set<std::string> options;
  for (const Json& trial : report["trials"]) {
    EXPECT_TRUE(options.insert(trial["options"]).second) << "tried twice: " << trial["options"];
    if (!trial.contains("median_ms")) continue;
    ++measured;
    EXPECT_GE(trial["gpu_ms"].size(), 1u);
    EXPECT_LE(trial["ms_ci"][0], trial["median_ms"]);
    EXPECT_GE(trial["ms_ci"][1], trial["median_ms"]);
  }
  EXPECT_GE(measured, 1u);
  // The options of the least error level that was met, given to render, have that error against the reference.
  Json found;
  for (const Json& level : report["errors"])
    if (level["options"].is_string()) found = level;
  if (!found.is_object()) found = {{"options", report["trials"][0]["options"]}, {"relmse", 1e9}};
  std::vector<std::string> render = {"render",  scene("spheres"), "--size", "32x18", "--device",          "cpu",
                                     "--quiet", "--exr-type",     "float",  "-o",    folder / "found.exr"};
  for (const std::string& word : words_of(found["options"])) render.push_back(word);
  ASSERT_EQ(candela(render).code, 0);
  ASSERT_EQ(candela({"reference", scene("spheres"), "--size", "32x18", "--spp",
                     std::to_string(report["reference"]["spp"].get<int>()), "-o", folder / "truth.exr", "--quiet"})
                .code,
            0);
  const Ended compared = candela({"compare", folder / "truth.exr", folder / "found.exr", "--json", "--quiet"});
  const double relmse = Json::parse(compared.out)["metrics"]["relmse"];
  EXPECT_LE(relmse, found["relmse"].get<double>()) << found;
  for (const Json& trial : report["trials"])
    if (trial["options"] == found["options"]) EXPECT_NEAR(relmse, trial["relmse"], 1e-6 + 1e-3 * relmse);
}

TEST(Tune, RefusesWhatItLooksFor) {
  for (const char* option : {"--quality", "--technique", "--set", "--samples"}) {
    const Ended ended = candela({"tune", scene("unlit-box"), option, "4"});
    EXPECT_EQ(ended.code, 2) << option;
    EXPECT_NE(ended.err.find(option), std::string::npos) << ended.err;
  }
  EXPECT_EQ(candela({"tune", scene("unlit-box"), "--seconds", "0"}).code, 2);
}

}  // namespace
}  // namespace candela::test
