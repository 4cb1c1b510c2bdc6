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
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "the scene has no light\nof 0 lights 0 have no shadows\n");
}

}  // namespace
}  // namespace candela::cli
