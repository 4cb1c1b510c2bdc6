#include "base/file_uses.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/files.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

class FileUses : public ::testing::Test {
 protected:
  void SetUp() override {
    forget_file_uses();
    folder = fs::path(testing::TempDir()) /
             (std::string("candela-uses-") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder / "sub");
    std::ofstream(folder / "a") << "bytes";
    fs::create_hard_link(folder / "a", folder / "hard");
    fs::create_symlink("a", folder / "soft");
    fs::create_symlink("sub", folder / "way");
    fs::create_symlink("sub/absent", folder / "to-absent");
    fs::create_symlink("loop", folder / "loop");
    mkfifo((folder / "pipe").c_str(), 0600);
  }
  void TearDown() override {
    forget_file_uses();
    fs::remove_all(folder);
  }
  bool same(const std::string& one, const std::string& other) const {
    const auto a = file_identity(folder / one), b = file_identity(folder / other);
    return a && b && *a == *b;
  }
  std::string refusal(const std::vector<NamedFile>& outputs) const {
    const auto fine = declare_outputs(outputs);
    if (fine) return "";
    EXPECT_EQ(fine.error().kind, ErrorKind::usage);
    return fine.error().text();
  }
  fs::path folder;
};

TEST_F(FileUses, AFileIsKnownUnderAllItsNames) {
  for (const char* name : {"./a", "sub/../a", "way/../a", "hard", "soft"}) EXPECT_TRUE(same("a", name)) << name;
  for (const char* name : {"to-absent", "way/absent", "sub/./absent", "sub/new/../absent"})
    EXPECT_TRUE(same("sub/absent", name)) << name;
  EXPECT_TRUE(same("new/deep/b", "way/../new/./deep/b"));
  for (const char* name : {"a", "sub/absent2", "absent", "sub/absent/absent"})
    EXPECT_FALSE(same("sub/absent", name)) << name;
  for (const char* name : {"loop", "pipe", "sub", "way", "."}) EXPECT_FALSE(file_identity(folder / name)) << name;
  EXPECT_FALSE(file_identity("/dev/null"));
}

TEST_F(FileUses, NothingThatWasReadIsAnOutput) {
  note_read({"SCENE", folder / "a"});
  for (const char* name : {"a", "hard", "soft", "sub/../a"}) {
    const std::string text = refusal({{"--timings", folder / name}});
    for (const std::string part : {"--timings: ", "SCENE", "name another file"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_NE(text.find((folder / name).string()), std::string::npos) << text;
  }
  EXPECT_EQ(refusal({{"--timings", folder / "b"}}), "");
  note_read({"--look", folder / "sub/absent"});
  EXPECT_NE(refusal({{"-o", folder / "to-absent"}}), "");
}

TEST_F(FileUses, WhatIsReadLaterIsCheckedToo) {
  EXPECT_EQ(refusal({{"-o", folder / "soft"}, {"--trace", folder / "b"}}), "");
  EXPECT_TRUE(check_outputs());
  ASSERT_TRUE(read_file(folder / "hard"));
  const auto checked = check_outputs();
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().text().find("-o: "), std::string::npos) << checked.error().text();
  EXPECT_NE(checked.error().text().find("hard"), std::string::npos) << checked.error().text();
}

TEST_F(FileUses, OutputsAreDifferentFiles) {
  EXPECT_NE(refusal({{"-o", folder / "y"}, {"--timings", folder / "y"}}), "");
  EXPECT_NE(refusal({{"-o", folder / "y"}, {"-o", folder / "./y"}}), "");
  EXPECT_NE(refusal({{"-o", folder / "y"}, {"-o", folder / "y"}}), "");
  EXPECT_NE(refusal({{"-o", folder / "sub/absent"}, {"-o", folder / "to-absent"}}), "");
  EXPECT_NE(refusal({{"-o", folder / "a"}, {"-o", folder / "hard"}}), "");
  for (const char* many : {"/dev/null", "pipe"})
    EXPECT_EQ(refusal({{"-o", folder / many}, {"--timings", folder / many}}), "") << many;
  EXPECT_EQ(refusal({{"-o", folder / "y"}}), "") << "nothing of what was refused is kept";
  EXPECT_EQ(refusal({{"-o", folder / "y"}, {"-o", folder / "z"}}), "") << "declared again";
  EXPECT_NE(refusal({{"--trace", folder / "way/../y"}}), "");
}

TEST_F(FileUses, WhatThisProcessWroteMayBeReadAgain) {
  EXPECT_EQ(refusal({{"-o", folder / "y"}}), "");
  ASSERT_TRUE(write_file_atomically(folder / "y", std::string_view("picture")));
  EXPECT_EQ(refusal({{"--report", folder / "y"}}).find("is read"), std::string::npos);
  forget_file_uses();
  ASSERT_TRUE(write_file_atomically(folder / "y", std::string_view("picture")));
  EXPECT_EQ(refusal({{"-o", folder / "y"}}), "");
  ASSERT_TRUE(read_file(folder / "y"));
  EXPECT_TRUE(check_outputs());
}

}  // namespace
}  // namespace candela
