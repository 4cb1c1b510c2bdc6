#include <gtest/gtest.h>

#include "cli/scene_notes.h"

namespace candela::cli {
namespace {

// A film of many frames says what holds for all of them once, whatever the numbers of each.
TEST(SaidOnce, WhatDiffersInItsNumbersIsTheSame) {
  testing::internal::CaptureStderr();
  SaidOnce said;
  for (int frame = 0; frame < 50; ++frame) {
    said.note("the scene has no light");
    said.note("of " + std::to_string(frame) + " lights " + std::to_string(2 * frame) + " have no shadows");
    said.note(frame % 2 == 0 ? "they are of the nodes 26-53, 55, 57-61" : "they are of the nodes 26-55, 57");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "the scene has no light\nof 0 lights 0 have no shadows\n"
            "they are of the nodes 26-53, 55, 57-61\n");
}

TEST(SaidOnce, WarningsOfAFilmAreSaidOnceAndAllKept) {
  testing::internal::CaptureStderr();
  std::vector<std::string> warnings;
  for (int frame = 0; frame < 5; ++frame) {
    FrameResult result;
    result.warnings = {std::to_string(frame + 3) + " lights are lost", "a texture is gone"};
    ASSERT_TRUE(note_frame(result, {}, Strictness::none, warnings));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: 3 lights are lost\nwarning: a texture is gone\n");
  EXPECT_EQ(warnings.size(), 6u);
}

}  // namespace
}  // namespace candela::cli
