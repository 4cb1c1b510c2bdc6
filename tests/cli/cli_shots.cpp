#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "program.h"

namespace candela::test::cli_shots {
namespace {

using Json = nlohmann::json;
const std::vector<std::string> small = {"--size", "32x18", "--device", "cpu", "--quiet"};

Ended render(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "render");
  arguments.insert(arguments.end(), small.begin(), small.end());
  return candela(arguments);
}

// Two cameras: one named, one not.
std::string two_cameras(const TestFolder& folder, bool carried = true) {
  Json j = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0, 1, 2}}}}},
            {"nodes",
             {{{"camera", 0}, {"translation", {0, 0, 3}}}, {{"camera", 1}, {"translation", {0, 0, 5}}}, {{"mesh", 0}}}},
            {"cameras",
             {{{"name", "Main/left"}, {"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}},
              {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
            {"accessors",
             {{{"bufferView", 0},
               {"componentType", 5126},
               {"count", 3},
               {"type", "VEC3"},
               {"min", {0, 0, 0}},
               {"max", {1, 1, 0}}}}},
            {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
            {"buffers", {{{"uri", "t.bin"}, {"byteLength", 36}}}}};
  if (!carried) j["nodes"][0].erase("camera"), j["nodes"][1].erase("camera");
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(folder / "t.bin", std::ios::binary).write(reinterpret_cast<const char*>(corners), sizeof corners);
  std::ofstream(folder / "t.gltf") << j.dump();
  return folder / "t.gltf";
}

TEST(Shots, SeveralFramesAreThoseOfCallsOfTheirOwn) {
  const TestFolder folder;
  const std::string animated = scene("animated");
  ASSERT_EQ(render({animated, "--frames", "3,0-6x6", "-o", folder / "{frame:03}.png"}).code, 0);
  EXPECT_EQ(files_in(folder.path()), (std::vector<std::string>{"000.png", "003.png", "006.png"}));
  ASSERT_EQ(render({animated, "--frame", "6", "-o", folder / "one.png"}).code, 0);
  EXPECT_EQ(bytes_of(folder / "one.png"), bytes_of(folder / "006.png"));
  EXPECT_NE(bytes_of(folder / "000.png"), bytes_of(folder / "006.png"));
}

TEST(Shots, AllCamerasEachInItsFile) {
  const TestFolder folder;
  const auto pictures = folder.path() / "pictures";
  const std::string file = two_cameras(folder);
  const Ended all = render({file, "--camera", "all", "-o", pictures / "{camera}.png", "--json"});
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(files_in(pictures), (std::vector<std::string>{"Main_left.png", "camera1.png"}));
  const Json result = Json::parse(all.out);
  ASSERT_EQ(result["pictures"].size(), 2u);
  EXPECT_EQ(result["pictures"][0]["camera"], "camera 'Main/left'");
  ASSERT_EQ(render({file, "--camera", "1", "-o", pictures / "one.png"}).code, 0);
  EXPECT_EQ(bytes_of(pictures / "one.png"), bytes_of(pictures / "camera1.png"));
  EXPECT_EQ(render({file, "--camera", "all", "-o", pictures / "x.png"}).code, 2);
  EXPECT_EQ(render({two_cameras(folder, false), "--camera", "all", "-o", pictures / "{camera}.png"}).code, 2);
}

TEST(Shots, ATurntableIsASequenceOfItsOwnLength) {
  const TestFolder folder;
  std::vector<std::string> arguments = {"sequence", scene("unlit-box"), "--turntable", "4", "-o", folder / "%d.png"};
  arguments.insert(arguments.end(), small.begin(), small.end());
  ASSERT_EQ(candela(arguments).code, 0);
  EXPECT_EQ(files_in(folder.path()), (std::vector<std::string>{"0.png", "1.png", "2.png", "3.png"}));
  EXPECT_NE(bytes_of(folder / "0.png"), bytes_of(folder / "1.png"));
  // Frame 1 of four, from 30 degrees on.
  ASSERT_EQ(render({scene("unlit-box"), "--turntable", "4", "--frame", "1", "-o", folder / "one.png"}).code, 0);
  EXPECT_EQ(bytes_of(folder / "one.png"), bytes_of(folder / "1.png"));
}

TEST(Shots, TheEnvironmentGivesOptionsAndTheCommandLineGoesFirst) {
  const TestFolder folder;
  const auto with = [&](const std::string& setting, const std::string& file, const std::string& size) {
    std::vector<std::string> all = {"env", setting,       CANDELA_PROGRAM, "render", scene("unlit-box"),
                                    "-o",  folder / file, "--device",      "cpu",    "--json"};
    if (!size.empty()) all.insert(all.end(), {"--size", size});
    const Ended ended = run_program(all);
    return ended.code == 0 ? Json::parse(ended.out)["job"]["size"].get<std::string>() : ended.err;
  };
  EXPECT_EQ(with("CANDELA_SIZE=40x20", "a.png", ""), "40x20");
  EXPECT_EQ(with("CANDELA_SIZE=40x20", "b.png", "16x16"), "16x16");
  EXPECT_NE(with("CANDELA_SIZE=40", "c.png", "").find("--size"), std::string::npos);
}

// What a file says is cut by nothing in it, reaches no terminal and forges no line of the log.
TEST(Shots, NamesFromFilesAreSafe) {
  const TestFolder folder;
  const std::string file = two_cameras(folder);
  Json j = Json::parse(bytes_of(file));
  j["cameras"][0]["name"] = std::string("cam\0one", 7);
  j["cameras"][1]["name"] = std::string("cam\0two\x1b]0;owned\a\nerror: forged", 28);
  j["extensionsUsed"] = {"EXT_\x1b[31m\nwarning: forged"};
  std::ofstream(file) << j.dump();
  const auto pictures = folder.path() / "pictures";
  const Ended all = candela(
      {"render", file, "--camera", "all", "-o", pictures / "{camera}.png", "--size", "16x9", "--device", "cpu"});
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(files_in(pictures).size(), 2u) << "two pictures became one file";
  EXPECT_EQ(files_in(pictures).front(), "cam_one.png");
  const Ended one = candela({"render", file, "--camera", "no such", "-o", pictures / "x.png", "--size", "16x9"});
  EXPECT_NE(one.code, 0);
  for (const std::string& err : {all.err, one.err}) {
    EXPECT_EQ(err.find('\x1b'), std::string::npos) << err;
    EXPECT_EQ(err.find("\nerror: forged"), std::string::npos) << err;
    EXPECT_EQ(err.find("\nwarning: forged"), std::string::npos) << err;
  }
}

}  // namespace
}  // namespace candela::test::cli_shots
