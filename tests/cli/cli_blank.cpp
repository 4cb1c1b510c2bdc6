#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "image/io.h"
#include "program.h"

namespace candela::test::cli_blank {
namespace {

// A triangle at the origin, and an unnamed camera 5 m before it whose node is turned by the quaternion given.
std::string camera_scene(const TestFolder& folder, const char* rotation, int cameras = 1) {
  std::string list;
  for (int i = 0; i < cameras; ++i)
    list += std::string(i ? "," : "") + R"({"type":"perspective","perspective":{"yfov":1,"znear":0.1}})";
  std::ofstream(folder / "turned.gltf") << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"camera":0,"translation":[0,0,5],"rotation":)"
                                        << rotation << R"(}],"cameras":[)" << list << R"(],
"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";
  return folder / "turned.gltf";
}
constexpr const char *away = "[0,1,0,0]", *towards = "[0,0,0,1]";

Ended render(const std::string& scene_file, const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"render", scene_file, "-o", out, "--size", "32x18"};
  words.insert(words.end(), more.begin(), more.end());
  return candela(words);
}

TEST(Blank, TheFilesOwnCameraThatLooksAwayIsWarnedOfAndStrictRefusesIt) {
  const TestFolder folder;
  const std::string file = camera_scene(folder, away);
  // Under a background alpha is 1 everywhere.
  for (const std::vector<std::string>& background :
       std::vector<std::vector<std::string>>{{}, {"--background", "0.1,0.2,0.3"}, {"--view", "heatmap_lights"}}) {
    const std::string out = folder / "a.png";
    const Ended plain = render(file, out, background);
    EXPECT_EQ(plain.code, 0) << plain.err;
    EXPECT_NE(plain.err.find("the frame is blank"), std::string::npos) << plain.err;
    std::filesystem::remove(out);
    auto strictly = background;
    strictly.push_back("--strict");
    const Ended strict = render(file, out, strictly);
    EXPECT_EQ(strict.code, 3) << strict.err;
    EXPECT_NE(strict.err.find("--strict refuses the frame"), std::string::npos) << strict.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << "refused before it is written";
    strictly.push_back("--allow-blank");
    EXPECT_EQ(render(file, out, strictly).code, 0);
  }
  const Ended film =
      candela({"sequence", file, "--frames", "0-2", "-o", folder / "%d.exr", "--size", "32x18", "--strict"});
  EXPECT_EQ(film.code, 3) << film.err;
  const std::string seen = camera_scene(folder, towards);
  for (const char* background : {"transparent", "0.1,0.2,0.3"}) {
    const Ended fine = render(seen, folder / "b.png", {"--strict", "--background", background});
    EXPECT_EQ(fine.code, 0) << fine.err;
    EXPECT_EQ(fine.err.find("blank"), std::string::npos) << fine.err;
  }
}

TEST(Blank, GoldensOfNothingAreRefused) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "golden/away");
  camera_scene(folder, away);
  std::ofstream(folder / "golden/away/golden.json") << R"({"scene": "turned.gltf", "job": {"size": "32x18"}})";
  const auto golden = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"golden"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--root", folder / "golden"});
    return candela(words);
  };
  const Ended refused = golden({"update", "--why", "first"});
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_NE(refused.err.find("--allow-blank"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "golden/away/golden.png"));
  ASSERT_EQ(golden({"update", "--why", "first", "--allow-blank"}).code, 0);
  const Ended check = golden({"check"});
  EXPECT_EQ(check.code, 1) << check.out << check.err;
  EXPECT_NE(check.out.find("the frame is blank"), std::string::npos) << check.out;
  EXPECT_EQ(golden({"check", "--allow-blank"}).code, 0);
}

TEST(NonFinite, InBothImagesIsRefusedUnlessAsked) {
  const TestFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  FloatImage image{.width = 2, .height = 1};
  for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, ChannelType::float32, {nan, 0.5f}, {}});
  ASSERT_TRUE(write_exr(folder / "nan.exr", image, ExrCompression::none));
  const Ended refused = candela({"compare", folder / "nan.exr", folder / "nan.exr", "--json"});
  EXPECT_EQ(refused.code, 1) << refused.out;
  EXPECT_NE(refused.err.find("--allow-nonfinite"), std::string::npos) << refused.err;
  EXPECT_EQ(nlohmann::json::parse(refused.out)["pass"], false);
  EXPECT_EQ(candela({"compare", folder / "nan.exr", folder / "nan.exr", "--allow-nonfinite"}).code, 0);
}

TEST(Messages, UnnamedCamerasAreListedByIndex) {
  const TestFolder folder;
  const Ended one = render(camera_scene(folder, towards), folder / "a.png", {"--camera", "Main"});
  EXPECT_EQ(one.code, 2);
  EXPECT_NE(one.err.find("by its index 0"), std::string::npos) << one.err;
  const Ended more = render(camera_scene(folder, towards, 3), folder / "a.png", {"--camera", "Main"});
  EXPECT_NE(more.err.find("there are 3 without names: take one by its index, 0 to 2"), std::string::npos) << more.err;
  EXPECT_EQ(more.err.find("''"), std::string::npos) << more.err;
}

TEST(Messages, RangesOfNumbersAreShort) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"bench", "spheres", "--budget-s", "0"},
                                             {"bench", "spheres", "--min-change", "-1"},
                                             {"bench", "spheres", "--timeout", "x"},
                                             {"render", scene("unlit-box"), "-o", "x.exr", "--time-budget", "-3"}}) {
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 2);
    EXPECT_LT(ended.err.size(), 300u) << ended.err;
    EXPECT_NE(ended.err.find("is not a number"), std::string::npos) << ended.err;
  }
}

TEST(Messages, UnknownMetricsGetASuggestion) {
  const Ended ended = candela({"compare", "a.exr", "b.exr", "--limit", "rmsee=1"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("did you mean 'rmse'"), std::string::npos) << ended.err;
}

TEST(Messages, FramesThatRunBackwardsAreRefused) {
  const Ended ended = candela({"sequence", scene("unlit-box"), "--frames", "5-2", "-o", "%d.exr"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("runs backwards: 2-5"), std::string::npos) << ended.err;
}

TEST(Messages, KnobsFitIntoALineAndFloatsAreShort) {
  for (const char* quality : {"draft", "normal", "high", "exact"}) {
    const Ended ended = candela({"list", "knobs", "--all", "--quality", quality});
    ASSERT_EQ(ended.code, 0);
    std::istringstream lines(ended.out);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120u) << line;
    EXPECT_EQ(ended.out.find("0.0099"), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find("lights.floor_lux"), std::string::npos);
    EXPECT_NE(ended.out.find("one of aabb, cone-sphere"), std::string::npos) << ended.out;
  }
}

TEST(Messages, AFilmOfOddSidesGrowsWhereThatIsAskedForAlone) {
  const TestFolder folder;
  std::vector<std::string> film = {"sequence", scene("unlit-box"), "--frames", "0-1",
                                   "--video",  folder / "a.mp4",   "--size",   "33x18"};
  const Ended refused = candela(film);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("take 32x18 or 34x18, --video-pad"), std::string::npos) << refused.err;
  film.emplace_back("--video-pad");
  const Ended padded = candela(film);
  EXPECT_EQ(padded.code, 0) << padded.err;
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>({"a.mp4"}));
}

// The documentation names the channels as files have them.
TEST(Messages, HeatMapChannelsAreNamedAsInTheFile) {
  const TestFolder folder;
  ASSERT_EQ(render(scene("street"), folder / "a.exr",
                   {"--layers", "heatmap_lights,heatmap_waste,heatmap_missed", "--exr-compression", "none"})
                .code,
            0);
  const std::string file = bytes_of(folder / "a.exr"), page = bytes_of(CANDELA_SOURCE_DIR "/docs/using/outputs.md");
  for (const char* channel : {"heatmap_lights.Y", "heatmap_waste.Y", "heatmap_missed.Y"}) {
    EXPECT_NE(file.find(channel), std::string::npos) << channel;
    EXPECT_NE(page.find("`" + std::string(channel) + "`"), std::string::npos) << channel;
  }
}

}  // namespace
}  // namespace candela::test::cli_blank
