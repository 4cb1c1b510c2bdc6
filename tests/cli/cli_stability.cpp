#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

Ended stability(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"bench", "--suite", "stability", "--quiet"});
  return candela(std::move(arguments));
}

// A scene or two of every family; bench/results has all of them.
TEST(Stability, ExtremeScenesAreAsTheyShouldBe) {
  const TestFolder folder;
  const Ended ended = stability(
      {"--only",
       "near 1e-4,1 mm at 1 km,orthographic to 1e7,inside a ball,1e6 m along,cancelling,a million times,1e9 cd,range "
       "1e-3,farther than "
       "floats,on a surface,at the camera,"
       "cone of 0.01 degrees,cone of 90,dark ones,metal mirror,albedo above,emissive,normal map of zero,NaN,infinity "
       "in the sky,"
       "without area,normals of zero,scale 0,scale 1e-8,scale 1e15,two keys,antipodal,beyond floats,through "
       "zero,65504,all black,all 1e30,"
       "exposure,images/1x1,images/127x61,16385,fog/extinction 0,slab,lamp,endless,over it,in it,1e6 m along and up",
       "--json", folder / "s.json", "--pictures", folder / "pictures"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  EXPECT_NE(ended.out.find("0 pixels not finite, 0 rows wrong"), std::string::npos) << ended.out;
  const Json json = Json::parse(bytes_of(folder / "s.json"));
  EXPECT_EQ(json["nonfinite"], 0);
  EXPECT_GE(json["scenes"], 50);
  EXPECT_EQ(json["faulty_rows"], 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/images-1x1.png"));
  for (const Json& row : json["rows"]) {
    EXPECT_TRUE(row["pass"]) << row;
    if (row["scene"] == "emissive 1e8") {
      EXPECT_GT(row["clamped"], 0) << "the file of halves holds less than the picture, and the table says so";
    }
    if (row["scene"] == "NaN in the sky") {
      EXPECT_EQ(row["warnings"].size(), 1u);
    }
  }
}

// Of lobes, glass and blended surfaces those whose arithmetic had to be mended, and one that stacks lobes.
TEST(Stability, MaterialsAtTheirEnds) {
  const TestFolder folder;
  const Ended ended = stability({"--only",
                                 "lobes/coat and sheen on white metal,lobes/film from 1000 nm,lobes/sheen of roughness "
                                 "1 along,glass/node of scale 2^60,glass/colour 0,"
                                 "light of 1e30 under alpha 1e-7 by weighted,light of 1e30 under alpha 1e-7 by moments",
                                 "--techniques", "clustered", "--json", folder / "s.json"});
  ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
  const Json json = Json::parse(bytes_of(folder / "s.json"));
  EXPECT_EQ(json["nonfinite"], 0);
  EXPECT_GE(json["scenes"], 7);
}

TEST(Stability, ClampedValuesAreCountedAndSaid) {
  const TestFolder folder;
  ASSERT_EQ(candela({"make-scene", "unlit-box", "-o", folder / "s.glb"}).code, 0);
  const std::vector<std::string> render = {"render", folder / "s.glb", "--size",  "16x12", "--samples",
                                           "1",      "--background",   "1e6,1,0", "--json"};
  std::vector<std::string> half = render, whole = render;
  half.insert(half.end(), {"-o", folder / "half.exr"});
  whole.insert(whole.end(), {"-o", folder / "whole.exr", "--exr-type", "float"});
  const Ended clamped = candela(half), kept = candela(whole);
  ASSERT_EQ(clamped.code, 0) << clamped.err;
  ASSERT_EQ(kept.code, 0) << kept.err;
  EXPECT_NE(clamped.err.find("stored as 65504"), std::string::npos) << clamped.err;
  EXPECT_NE(Json::parse(clamped.out)["warnings"].dump().find("stored as 65504"), std::string::npos) << clamped.out;
  EXPECT_EQ(kept.err.find("stored as 65504"), std::string::npos) << kept.err;
}

TEST(Stability, SamplesThatTheDeviceLacksAreNoSilentlyDarkerPicture) {
  const TestFolder folder;
  ASSERT_EQ(candela({"make-scene", "unlit-box", "-o", folder / "s.glb"}).code, 0);
  for (const char* samples : {"1", "2", "4", "8"}) {
    const std::string file = folder / (std::string(samples) + ".exr");
    const Ended ended = candela(
        {"render", folder / "s.glb", "--size", "16x12", "--samples", samples, "--background", "1,1,1", "-o", file});
    if (ended.code == 0) {
      const auto image = read_image(file);
      ASSERT_TRUE(image);
      for (const float alpha : image->find("A")->f) ASSERT_EQ(alpha, 1.0f) << samples << " samples";
    } else {
      EXPECT_EQ(ended.code, 4) << ended.err;
      EXPECT_NE(ended.err.find(std::string("no ") + samples + " samples"), std::string::npos) << ended.err;
    }
  }
}

TEST(Stability, FindsLostEnergy) {
  // A cap drops all but one of ten thousand lights.
  const Ended ended = stability({"--only", "000 spots in one place", "--techniques", "clustered", "--set",
                                 "lights.cap=1", "--set", "lights.few=0"});
  EXPECT_EQ(ended.code, 1) << ended.out << ended.err;
  EXPECT_NE(ended.out.find("of the plain scene's energy"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("WRONG"), std::string::npos) << ended.out;
}

TEST(Stability, ASuiteFileChoosesAndTheCommandLineGoesOver) {
  const TestFolder folder;
  std::ofstream(folder / "s.json")
      << R"({"suite": "stability", "families": ["images"], "sizes": ["5x7"], "only": ["5x7"],
                                          "techniques": ["clustered"], "seed": 3})";
  const auto rows = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"bench", folder / "s.json", "--quiet", "--json", "-"});
    const Ended ended = candela(std::move(more));
    EXPECT_EQ(ended.code, 0) << ended.err;
    return Json::parse(ended.out, nullptr, false);
  };
  const Json chosen = rows({}), over = rows({"--techniques", "brute-force", "--seed", "4"});
  ASSERT_EQ(chosen["rows"].size(), 1u) << chosen;
  EXPECT_EQ(chosen["rows"][0]["scene"], "5x7");
  EXPECT_EQ(chosen["rows"][0]["technique"], "clustered");
  EXPECT_EQ(chosen["rows"][0]["pixels"], 35);
  EXPECT_EQ(chosen["seed"], 3);
  ASSERT_EQ(over["rows"].size(), 1u) << over;
  EXPECT_EQ(over["rows"][0]["technique"], "brute-force");
  EXPECT_EQ(over["seed"], 4);

  std::ofstream(folder / "bad.json") << R"({"suite": "stability", "families": ["imags"]})";
  const Ended bad = candela({"bench", folder / "bad.json"});
  EXPECT_EQ(bad.code, 3) << bad.err;
  EXPECT_NE(bad.err.find("/families/0"), std::string::npos) << bad.err;
  for (const std::vector<std::string>& beside :
       std::vector<std::vector<std::string>>{{"street"}, {"--error"}, {"--suite", "exactness"}, {"--lights", "3"}}) {
    std::vector<std::string> arguments = {"bench", folder / "s.json"};
    arguments.insert(arguments.end(), beside.begin(), beside.end());
    EXPECT_EQ(candela(arguments).code, 2) << beside.front();
  }
}

TEST(Stability, UsageErrorsSayWhatIsMeant) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{{"--only", "no such scene"},
                                                                                         {"--techniques", "brut-force"},
                                                                                         {"--set", "lights.cap"},
                                                                                         {"--lights", "3"},
                                                                                         {"--count", "3"}}) {
    const Ended ended = stability(arguments);
    EXPECT_EQ(ended.code, 2) << arguments.back() << ": " << ended.err;
    EXPECT_FALSE(ended.err.empty());
  }
}

}  // namespace
}  // namespace candela::test
