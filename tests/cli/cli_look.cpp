// Which look file a command reads, and what it says of it.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

std::string box_in(const TestFolder& folder) {
  const std::string file = folder / "box.glb";
  std::filesystem::copy_file(CANDELA_SOURCE_DIR "/scenes/unlit-box/unlit-box.glb", file);
  return file;
}
std::vector<std::string> words(const std::string& command, const std::string& scene, const std::string& output,
                               std::vector<std::string> more = {}) {
  std::vector<std::string> all = {command, scene, "--size", "16x12", "--json"};
  if (command == "plan")
    all.insert(all.end(), {"-o", "x.png"});
  else
    all.insert(all.end(), {"-o", output});
  if (command == "sequence") all.insert(all.end(), {"--frames", "0-1"});
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

TEST(Look, BesideTheSceneIsRead) {
  const TestFolder folder;
  const std::string scene = box_in(folder), look = folder / "box.look.json";
  std::ofstream(look) << R"({"sky": {"gradient": {}}, "exposure": {"ev": 1}})";
  for (const std::string command : {"render", "sequence", "plan", "reference"}) {
    const std::string out = folder / (command == "sequence" ? "a%04d.png" : "a.png");
    const Ended found = candela(words(command, scene, out));
    ASSERT_EQ(found.code, 0) << found.err;
    const Json j = Json::parse(found.out);
    EXPECT_EQ(j["look"]["file"], look) << command;
    EXPECT_EQ(j["look"]["beside_scene"], true) << command;
    EXPECT_EQ(j["look"]["switched_on"], Json({"sky gradient", "exposure"})) << command;
    if (command != "plan") EXPECT_NE(found.err.find("beside the scene"), std::string::npos) << found.err;
    const Ended none = candela(words(command, scene, out, {"--look", "none"}));
    ASSERT_EQ(none.code, 0) << none.err;
    EXPECT_TRUE(!Json::parse(none.out).contains("look") || Json::parse(none.out)["look"].is_null()) << command;
    // A look that is given is the only one.
    const std::string other = folder / "other.json";
    std::ofstream(other) << R"({"bloom": {}})";
    const Ended given = candela(words(command, scene, out, {"--look", other}));
    ASSERT_EQ(given.code, 0) << given.err;
    EXPECT_EQ(Json::parse(given.out)["look"]["file"], other) << command;
    EXPECT_EQ(Json::parse(given.out)["look"]["beside_scene"], false) << command;
  }
  std::ofstream(look) << R"({"skyy": {}})";
  const Ended wrong = candela(words("plan", scene, ""));
  EXPECT_EQ(wrong.code, 3);
  EXPECT_NE(wrong.err.find("did you mean 'sky'"), std::string::npos) << wrong.err;
}

TEST(Look, MayNameImagesOfItsOwnFolderAlone) {
  const TestFolder folder;
  const std::string scene = box_in(folder), look = folder / "box.look.json";
  for (const char* image : {"../elsewhere.exr", "/etc/hostname"}) {
    std::ofstream(look) << R"({"sky": {"image": ")" << image << R"("}})";
    const Ended ended = candela(words("plan", scene, ""));
    EXPECT_EQ(ended.code, 3) << ended.err;
    EXPECT_NE(ended.err.find("box.look.json: /sky"), std::string::npos) << ended.err;
  }
  std::ofstream(look) << R"({"sky": {"image": "nowhere.exr"}})";
  EXPECT_EQ(candela(words("plan", scene, "")).code, 3);
}

TEST(Look, SchemaIsPrinted) {
  const Ended ended = candela({"list", "look-schema"});
  ASSERT_EQ(ended.code, 0);
  EXPECT_TRUE(Json::parse(ended.out)["properties"].contains("sky"));
}

// A job in a picture's metadata makes the picture again: what the look says is not written over by defaults.
TEST(Look, IsPartOfTheJob) {
  const TestFolder folder;
  const std::string scene = box_in(folder);
  const Json job = Json::parse(candela(words("render", scene, folder / "a.png")).out)["job"];
  EXPECT_FALSE(job.contains("exposure"));
  EXPECT_FALSE(job.contains("tonemap"));
  const Json given = Json::parse(
      candela(words("render", scene, folder / "a.png", {"--exposure", "0", "--tonemap", "agx"})).out)["job"];
  EXPECT_EQ(given["exposure"], 0);
  EXPECT_EQ(given["tonemap"], "agx");
}

}  // namespace candela::test
