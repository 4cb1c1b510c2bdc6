#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
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
      candela({"tune", scene("spheres"), "--size", "32x18", "--seconds", "12", "--device", "cpu", "--quiet", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json report = Json::parse(ended.out);
  const std::string size = report["errors_of"];  // smaller than asked where the machine is slow
  size_t measured = 0;
  for (const Json& trial : report["trials"]) {
    if (!trial.contains("median_ms")) continue;
    ++measured;
    EXPECT_GE(trial["gpu_ms"].size(), 6u);
    EXPECT_LE(trial["ms_ci"][0], trial["median_ms"]);
    EXPECT_GE(trial["ms_ci"][1], trial["median_ms"]);
  }
  EXPECT_GE(measured, 1u);
  // The options of the least error level that was met, given to render, have that error against quality exact.
  Json found;
  for (const Json& level : report["errors"])
    if (level["options"].is_string()) found = level;
  if (!found.is_object()) found = {{"options", report["trials"][0]["options"]}, {"relmse", 1e9}};
  const auto render = [&](std::vector<std::string> options, const std::string& file) {
    options.insert(options.begin(), {"render", scene("spheres")});
    options.insert(options.end(), {"--size", size, "--device", "cpu", "--quiet", "--exr-type", "float", "-o", file});
    return candela(options).code;
  };
  ASSERT_EQ(render(words_of(found["options"]), folder / "found.exr"), 0);
  ASSERT_EQ(render({"--quality", "exact"}, folder / "exact.exr"), 0);
  const Ended compared = candela({"compare", folder / "exact.exr", folder / "found.exr", "--json", "--quiet"});
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
