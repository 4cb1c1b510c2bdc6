// Options of paths and instances say what a look says, for every command that makes pictures.
#include <gtest/gtest.h>

#include <fstream>

#include "program.h"

namespace candela::test {
namespace {

namespace fs = std::filesystem;

std::string lamps() { return scene("lamp-paths"); }
std::string beside(const std::string& name) {
  return (fs::path(CANDELA_SOURCE_DIR) / "scenes/lamp-paths" / name).string();
}
std::vector<std::string> words(const std::string& command, const std::string& output,
                               const std::vector<std::string>& more) {
  std::vector<std::string> all = {command, lamps(), "-o", output, "--size", "48x27", "--time", "1.5"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}
std::vector<std::string> as_options() {
  return {"--look",
          "none",
          "--camera-path",
          beside("camera.txt") + ",seconds=4,constant-speed,look-at=-0.3:0.9:-0.6",
          "--path",
          "light Red=" + beside("red.txt") + ",closed,seconds=4,constant-speed",
          "--path",
          "light Green=" + beside("green.txt") + ",seconds=4",
          "--path",
          "light Blue=" + beside("blue.txt") + ",times=" + beside("blue-times.txt") + ",interpolation=cubic",
          "--instances",
          "Stone=" + beside("stones.txt")};
}
// Pixels alone: the metadata names the look.
std::string pixels_of(const std::string& file, const std::string& as) {
  const Ended ended = candela({"compare", file, as, "--json"});
  return ended.code == 0 && ended.out.find("\"differing\": 0") != std::string::npos ? "" : ended.out + ended.err;
}

}  // namespace

TEST(Paths, OptionsGiveThePictureOfTheLook) {
  const TestFolder folder;
  for (const std::string command : {"render", "reference"}) {
    std::vector<std::string> more;
    if (command == "reference") more = {"--spp", "2"};
    const std::string by_look = folder / (command + "-look.png"), by_options = folder / (command + "-options.png");
    const Ended look = candela(words(command, by_look, more));
    ASSERT_EQ(look.code, 0) << look.err;
    std::vector<std::string> options = as_options();
    options.insert(options.end(), more.begin(), more.end());
    const Ended given = candela(words(command, by_options, options));
    ASSERT_EQ(given.code, 0) << given.err;
    EXPECT_EQ(pixels_of(by_look, by_options), "") << command;
    // Without any of it the picture is another.
    more.insert(more.end(), {"--look", "none"});
    const Ended none = candela(words(command, folder / "none.png", more));
    ASSERT_EQ(none.code, 0) << none.err;
    EXPECT_NE(pixels_of(by_look, folder / "none.png"), "") << command;
  }
}

TEST(Paths, MalformedFilesAreExit3AndWriteNothing) {
  const TestFolder folder;
  const auto file = [&](const std::string& text) {
    std::ofstream(folder / "file.txt") << text;
    return folder / "file.txt";
  };
  const std::string out = folder / "a.png";
  const auto error = [&](const std::string& option, const std::string& value) {
    const Ended ended = candela(words("render", out, {option, value}));
    EXPECT_EQ(ended.code, 3) << ended.err;
    EXPECT_FALSE(fs::exists(out));
    return ended.err;
  };
  EXPECT_NE(error("--camera-path", file("0 0 1\n0 0\n")).find("file.txt:2: the line holds 2 numbers"),
            std::string::npos);
  EXPECT_NE(error("--path", "Red=" + beside("red.txt") + ",times=" + file("0 0\n2 1\n1 2\n")).find("file.txt:3: "),
            std::string::npos);
  EXPECT_NE(error("--instances", "Stone=" + file("1 1 1\n0 0 0\n")).find("file.txt:1: the last instance has 2"),
            std::string::npos);
  EXPECT_EQ(candela(words("render", out, {"--path", "Rde=" + beside("red.txt")})).code, 2);
  // What is read is not written over.
  const std::string points = file("0 0 1\n");
  fs::rename(points, folder / "points.png");
  EXPECT_EQ(candela(words("render", folder / "points.png", {"--camera-path", folder / "points.png"})).code, 2);
}

TEST(Paths, GoldensNameTheirFilesFromTheRoot) {
  const TestFolder folder;
  fs::copy(fs::path(CANDELA_SOURCE_DIR) / "scenes/lamp-paths", folder / "scene");
  fs::remove(folder / "scene/lamp-paths.look.json");
  const std::vector<std::string> add = {"golden",
                                        "add",
                                        "scene/lamp-paths.glb",
                                        "--size",
                                        "32x18",
                                        "--name",
                                        "one",
                                        "--camera-path",
                                        "scene/camera.txt,look-at=0:1:0",
                                        "--instances",
                                        "Stone=scene/stones.txt"};
  const Ended added = candela(add, folder.path());
  ASSERT_EQ(added.code, 0) << added.err;
  const std::string manifest = bytes_of(folder / "golden/one/golden.json");
  EXPECT_NE(manifest.find("\"scene/camera.txt\""), std::string::npos) << manifest;
  EXPECT_NE(manifest.find("\"scene/stones.txt\""), std::string::npos) << manifest;
  const Ended checked = candela({"golden", "check", "--root", folder / "golden"});
  EXPECT_EQ(checked.code, 0) << checked.err;
  std::ofstream(folder / "scene/camera.txt") << "9 9 9\n";
  EXPECT_EQ(candela({"golden", "check", "--root", folder / "golden"}).code, 1);
}

TEST(Paths, AllFramesReachTheirEnd) {
  const TestFolder folder;
  const Ended ended = candela({"render", lamps(), "-o", folder / "a.####.png", "--size", "16x9", "--fps", "1",
                               "--frames", "all", "--path", "Red=" + beside("red.txt") + ",seconds=6"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(files_in(folder.path()).size(), 7u);
}

}  // namespace candela::test
