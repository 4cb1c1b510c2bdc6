#include "base/input.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "base/files.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

// A folder with a scene's folder in it; the rules are the program's again afterwards.
class Input : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-input-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder / "scene/textures");
    fs::create_directories(folder / "scene-of-another");
    for (const char* file : {"scene/a.bin", "scene/textures/b.png", "secret", "scene-of-another/c.bin"})
      std::ofstream(folder / file) << "bytes";
    fs::create_symlink("../secret", folder / "scene/link-out");
    fs::create_symlink("textures/b.png", folder / "scene/link-in");
    fs::create_symlink("loop", folder / "scene/loop");
    mkfifo((folder / "scene/fifo").c_str(), 0600);
  }
  void TearDown() override {
    set_input_rules({});
    fs::remove_all(folder);
  }
  std::string refusal(const std::string& name) const {
    const auto allowed = check_named_file(folder / "scene" / name, folder / "scene");
    return allowed ? "" : allowed.error().message;
  }
  fs::path folder;
};

TEST_F(Input, ANamedFileLiesBelowTheFolderOfWhatNamesIt) {
  for (const char* name : {"a.bin", "textures/b.png", "textures/../a.bin", "./a.bin", "link-in", "absent.bin"})
    EXPECT_EQ(refusal(name), "") << name;
  for (const char* name : {"../secret", "/etc/passwd", "textures/../../secret", "link-out", "/proc/self/environ",
                           "../scene-of-another/c.bin", "../absent"}) {
    EXPECT_NE(refusal(name).find("a file may name only files below its own folder"), std::string::npos)
        << name << ": " << refusal(name);
    EXPECT_NE(refusal(name).find("--allow-path"), std::string::npos) << name;
  }
  EXPECT_NE(refusal("loop").find("cannot be followed"), std::string::npos) << refusal("loop");
  for (const char* name : {"fifo", "textures", "."})
    EXPECT_NE(refusal(name).find("no regular file"), std::string::npos) << name << ": " << refusal(name);
}

TEST_F(Input, FurtherFoldersCanBeAllowed) {
  set_input_rules({.allowed_folders = {folder / "scene-of-another/", "/nowhere"}});
  EXPECT_EQ(refusal("../scene-of-another/c.bin"), "");
  EXPECT_NE(refusal("../secret"), "");
  set_input_rules({.allowed_folders = {folder}});
  EXPECT_EQ(refusal("link-out"), "");
}

// A link that changes between the check and the opening.
TEST_F(Input, WhatWasOpenedIsChecked) {
  const fs::path link = folder / "scene/turning";
  fs::create_symlink("a.bin", link);
  ASSERT_TRUE(check_named_file(link, folder / "scene"));
  ASSERT_TRUE(read_file(link));
  fs::remove(link);
  fs::create_symlink("../secret", link);
  const auto outside = read_file(link);
  ASSERT_FALSE(outside);
  EXPECT_NE(outside.error().message.find("lies outside"), std::string::npos) << outside.error().text();
  EXPECT_TRUE(read_file(folder / "secret")) << "the user may name it";
  set_input_rules({.allowed_folders = {folder}});
  EXPECT_TRUE(read_file(link));
}

TEST_F(Input, ATurningLinkNeverLeadsOutside) {
  const fs::path link = folder / "scene/turning", other = folder / "scene/other";
  std::ofstream(folder / "secret") << "secret";
  fs::create_symlink("a.bin", link);
  std::atomic<bool> done = false;
  std::thread turn([&] {
    for (int i = 0; !done; ++i) {
      fs::create_symlink(i % 2 ? "a.bin" : "../secret", other);
      fs::rename(other, link);
    }
  });
  int inside = 0, refused = 0, secret = 0;
  for (int i = 0; i < 3000; ++i) {
    if (!check_named_file(link, folder / "scene")) continue;
    const auto bytes = read_file(link);
    ++(!bytes ? refused : bytes->size() == 6 ? secret : inside);
  }
  done = true;
  turn.join();
  EXPECT_EQ(secret, 0) << inside << " inside, " << refused << " refused";
  EXPECT_GT(inside, 0);
}

// The folder of what names a file may turn too.
TEST_F(Input, AFileIsHeldToThePlaceOfWhatNamesIt) {
  fs::create_directories(folder / "scene/sub");
  fs::create_directories(folder / "outside");
  std::ofstream(folder / "scene/sub/s.gltf") << "{}";
  std::ofstream(folder / "outside/t.png") << "secret";
  const fs::path turning = folder / "scene/turning";
  fs::create_symlink("sub", turning);
  ASSERT_TRUE(check_named_file(turning / "s.gltf", folder / "scene", "suite.json"));
  fs::remove(turning);
  fs::create_symlink("../outside", turning);
  ASSERT_TRUE(check_named_file(turning / "t.png", turning, turning / "s.gltf"));
  EXPECT_FALSE(read_file(turning / "t.png"));
}

TEST_F(Input, TheWorkingFolderIsAFolderToo) {
  EXPECT_TRUE(check_named_file("a.bin", ""));
  EXPECT_FALSE(check_named_file("../a.bin", ""));
}

TEST_F(Input, WhatIsNoRegularFileIsRefusedAtOnce) {
  for (const auto& [name, what] :
       {std::pair((folder / "scene/fifo").string(), "a FIFO"), std::pair(folder.string(), "a folder"),
        std::pair(std::string("/dev/zero"), "a device")}) {
    const auto bytes = read_file(name);
    ASSERT_FALSE(bytes) << name;
    EXPECT_EQ(bytes.error().text(), fmt::format("{}: is {}, not a regular file", name, what));
    EXPECT_FALSE(check_regular_file(name)) << name;
  }
  EXPECT_TRUE(check_regular_file(folder / "secret"));
  EXPECT_FALSE(check_regular_file(folder / "absent"));
  EXPECT_GT(read_file("/proc/self/status")->size(), 100u) << "its size is said to be 0";
}

TEST_F(Input, TheBudgetIsForTheSum) {
  set_input_rules({.decode_budget_bytes = uint64_t(10) << 20});
  uint64_t sum = 0;
  EXPECT_TRUE(charge_decoded(sum, 6 << 20, "a.png"));
  EXPECT_TRUE(charge_decoded(sum, 4 << 20, "b.png"));
  const auto over = charge_decoded(sum, 1, "c.png");
  ASSERT_FALSE(over);
  EXPECT_EQ(over.error().kind, ErrorKind::input);
  EXPECT_EQ(over.error().place, "c.png");
  for (const char* part : {"the sum of textures, sky and meshes is 11 MiB", "budget of 10 MiB", "--decode-budget-mb"})
    EXPECT_NE(over.error().message.find(part), std::string::npos) << over.error().message;
}

}  // namespace
}  // namespace candela
