#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace candela::test::cli_compare {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> small = {"--size", "24x16", "--quiet"};

Ended compared(const std::string& a, const std::string& b, std::vector<std::string> more) {
  std::vector<std::string> words = {"compare", a, b, "--json", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  return candela(words);
}

class CompareImages : public testing::Test {
 protected:
  std::string made(const std::string& command, const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words = {command, scene("spheres"), "-o", folder / name};
    words.insert(words.end(), small.begin(), small.end());
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return folder / name;
  }
  TestFolder folder;
};

TEST_F(CompareImages, RenderAgainstReferenceSaysItsNoiseAndEachLayer) {
  const std::string truth = made("reference", "truth.exr", {"--spp", "4", "--visibility", "off"});
  const std::string image = made("render", "image.exr", {"--layers", "depth,object_id"});
  const std::string plain = made("render", "plain.exr", {});
  const Ended ended = compared(truth, plain, {"--hdr-flip", "-4,4,3", "--region", "0,0,8,8", "--region", "12,4,6,6"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.out.starts_with("{\n  \"nonfinite\"")) << ended.out;
  const Json json = Json::parse(ended.out);
  EXPECT_EQ(json["nonfinite"]["test"], 0);
  EXPECT_GT(json["noise_floor"]["rmse"], 0);
  EXPECT_EQ(json["hdr_flip_exposures"]["count"], 3);
  EXPECT_EQ(json["regions"].size(), 2u);
  for (const char* metric :
       {"max", "mae", "rmse", "relmse", "relmse-trimmed", "p99.9", "hdr-flip", "flip", "ssim", "psnr"})
    EXPECT_TRUE(json["metrics"].contains(metric)) << metric;
  EXPECT_EQ(json["relmse_epsilon"], 0.01);
  EXPECT_TRUE(json["max_at"].contains("channel"));
  // A reference compared with itself is below its own noise, and says so to readers as well.
  const Json self = Json::parse(compared(truth, truth, {"--hdr-flip", "off"}).out);
  EXPECT_EQ(self["noise_floor"]["below"].size(), 2u);
  EXPECT_FALSE(self["metrics"].contains("hdr-flip"));
  const Ended text = candela({"compare", truth, truth, "--hdr-flip", "off", "--quiet"});
  EXPECT_NE(text.out.find("below the reference's noise"), std::string::npos) << text.out;

  // Layers that one file lacks are no match, whatever the others say.
  const Ended lacking = compared(truth, image, {"--hdr-flip", "off"});
  EXPECT_EQ(lacking.code, 1) << lacking.err;
  EXPECT_EQ(Json::parse(lacking.out)["only_in_test"], (Json{"depth", "object_id"}));

  const Json layers = Json::parse(compared(image, image, {"--hdr-flip", "off"}).out)["layers"];
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0]["kind"], "depth");
  EXPECT_EQ(layers[1]["kind"], "ids");
  EXPECT_EQ(layers[1]["metrics"]["differing"], 0);
}

TEST_F(CompareImages, ALimitIsBrokenByARegionAlone) {
  const std::string a = made("render", "a.exr", {}), b = made("render", "b.exr", {"--set", "resolve.samples=1"});
  const double whole = Json::parse(compared(a, b, {"--hdr-flip", "off"}).out)["metrics"]["mae"];
  ASSERT_GT(whole, 0);
  const std::string limit = "mae=" + std::to_string(whole * 1.0001 + 1e-6);
  EXPECT_EQ(compared(a, b, {"--hdr-flip", "off", "--limit", limit}).code, 0);
  // Some column of eight pixels is worse than the mean of all.
  int broken = 0;
  for (const char* region : {"0,0,8,16", "8,0,8,16", "16,0,8,16"})
    broken += compared(a, b, {"--hdr-flip", "off", "--limit", limit, "--region", region}).code == 1;
  EXPECT_GE(broken, 1);
  EXPECT_LE(broken, 2);
}

TEST_F(CompareImages, APageShowsBothPicturesAndWhatBroke) {
  const std::string a = made("render", "a.png", {}), b = made("render", "b.png", {"--exposure", "1"});
  EXPECT_EQ(compared(a, b, {"--limit", "flip=0.001", "--limit", "max=100", "--html", folder / "page.html"}).code, 1);
  const std::string page = bytes_of(folder / "page.html");
  EXPECT_NE(page.find("<li class=\"wrong\">flip is "), std::string::npos);
  EXPECT_EQ(page.find("<li class=\"wrong\">"), page.rfind("<li class=\"wrong\">")) << "max is within its limit";
  EXPECT_NE(page.find("<li>max is "), std::string::npos);
  size_t pictures = 0;
  for (size_t at = page.find("data:image/png"); at != std::string::npos; at = page.find("data:image/png", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 7u) << "both, FLIP, the difference, and the three cut out around its largest pixel";
  EXPECT_NE(page.find("Largest difference: "), std::string::npos);
}

TEST_F(CompareImages, WhatWasNotMeasuredIsSaid) {
  const std::string a = made("render", "a.png", {}), b = made("render", "b.png", {"--set", "resolve.samples=1"});
  const Ended display = compared(a, b, {"--limit", "hdr-flip=1"});
  EXPECT_EQ(display.code, 1);
  EXPECT_NE(display.err.find("was not measured: it is of scene-linear colour"), std::string::npos) << display.err;
  EXPECT_EQ(display.err.find("nan"), std::string::npos) << display.err;
  // A heat map of an earlier run must not be taken for this one's.
  const std::string other = folder / "c.png";
  ASSERT_EQ(candela({"render", scene("spheres"), "-o", other, "--size", "8x8", "--quiet"}).code, 0);
  const Ended refused = compared(a, other, {"--heatmap", folder / "heat.png"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("heat.png is not written"), std::string::npos) << refused.err;
  EXPECT_EQ(compared(a, b, {"--heatmap", folder / "heat.png"}).err, "");
  EXPECT_TRUE(std::filesystem::exists(folder / "heat.png"));
}

TEST(CompareUsage, BadRegionsAndExposures) {
  for (const auto& [option, value, said] :
       {std::tuple("--region", "1,2,3", "X,Y,WIDTH,HEIGHT"), std::tuple("--region", "0,0,0,4", "X,Y,WIDTH,HEIGHT"),
        std::tuple("--hdr-flip", "4,-4,9", "START,STOP,COUNT")}) {
    const Ended ended = candela({"compare", "a.exr", "b.exr", option, value});
    EXPECT_EQ(ended.code, 2) << option << " " << value;
    EXPECT_NE(ended.err.find(said), std::string::npos) << ended.err;
  }
}

}  // namespace
}  // namespace candela::test::cli_compare
