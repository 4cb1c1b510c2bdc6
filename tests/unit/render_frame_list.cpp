#include <gtest/gtest.h>

#include "job/job.h"
#include "render/frame_names.h"

namespace candela {
namespace {

using Frames = FrameList;

TEST(FrameList, ReadsWhatTheFieldWrites) {
  EXPECT_EQ(parse_frame_list("7").value(), (Frames{7}));
  EXPECT_EQ(parse_frame_list("0-4").value(), (Frames{0, 1, 2, 3, 4}));
  EXPECT_EQ(parse_frame_list("1-10x4").value(), (Frames{1, 5, 9}));
  EXPECT_EQ(parse_frame_list("1-9x4").value(), (Frames{1, 5, 9}));
  EXPECT_EQ(parse_frame_list("2,4,10-12").value(), (Frames{2, 4, 10, 11, 12}));
  EXPECT_EQ(parse_frame_list("2, 4").value(), (Frames{2, 4}));
  EXPECT_EQ(parse_frame_list("-5--2").value(), (Frames{-5, -4, -3, -2}));
  EXPECT_EQ(parse_frame_list("-2-1").value(), (Frames{-2, -1, 0, 1}));
}

TEST(FrameList, KeepsTheOrderWrittenWithoutDuplicates) {
  EXPECT_EQ(parse_frame_list("9,1-3,2,9").value(), (Frames{9, 1, 2, 3}));
}

TEST(FrameList, RangesThatMeet) {
  EXPECT_EQ(parse_frame_list("0-8x2,0-8").value(), (Frames{0, 2, 4, 6, 8, 1, 3, 5, 7}));
  EXPECT_EQ(parse_frame_list("0-3,2-5,1").value(), (Frames{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(parse_frame_list("5,1,7,9,11,7").value(), (Frames{5, 1, 7, 9, 11}));
  const Frames many = parse_frame_list("0-9999999").value();
  EXPECT_EQ(many.size(), 10'000'000u);
  EXPECT_EQ(many.every(3, 1)[1], 4);
  EXPECT_EQ(many.every(3, 1).place_of(4), 1u);
  EXPECT_FALSE(many.every(3, 1).contains(5));
}

TEST(FrameList, RefusesSlips) {
  for (const char* text : {"", ",", "1,", "a", "1-", "1-x", "1-5x", "1-5x0", "1-5x-1", "1 to 5", "1.5", "1-5-9",
                           "0-99999999999", "99999999999999999999"}) {
    const auto frames = parse_frame_list(text);
    ASSERT_FALSE(frames) << text;
    EXPECT_EQ(frames.error().kind, ErrorKind::usage) << text;
  }
}

// A slip more often than a wish; whoever wants the order writes the frames one by one.
TEST(FrameList, ARangeThatRunsBackwardsIsNamed) {
  for (const char* text : {"5-2", "1,5-2", "-1--3", "9-1x2"}) {
    const auto frames = parse_frame_list(text);
    ASSERT_FALSE(frames) << text;
    EXPECT_NE(frames.error().message.find("runs backwards"), std::string::npos) << frames.error().message;
  }
  EXPECT_EQ(parse_frame_list("3,2,1").value(), (Frames{3, 2, 1}));
}

TEST(FrameList, EndsOfTheNumberRange) {
  EXPECT_EQ(parse_frame_list("9223372036854775806-9223372036854775807").value(), (Frames{INT64_MAX - 1, INT64_MAX}));
  EXPECT_FALSE(parse_frame_list("-9223372036854775808-9223372036854775807"));
}

TEST(FrameRate, ReadsFractionsDecimalsAndBroadcastRates) {
  const auto expect = [](const char* text, int64_t numerator, int64_t denominator) {
    const auto rate = parse_frame_rate(text);
    ASSERT_TRUE(rate) << text;
    EXPECT_EQ(rate->numerator, numerator) << text;
    EXPECT_EQ(rate->denominator, denominator) << text;
    EXPECT_EQ(parse_frame_rate(rate->text())->numerator, numerator) << text;
  };
  expect("24", 24, 1);
  expect("24000/1001", 24000, 1001);
  expect("23.976", 24000, 1001);
  expect("29.97", 30000, 1001);
  expect("12.5", 25, 2);
  expect("50/2", 25, 1);
  for (const char* text :
       {"", "0", "-24", "24/0", "24/", "1e3", "24.", "nan", "24fps", "1/2/3", "99999999999999999999"})
    EXPECT_FALSE(parse_frame_rate(text)) << text;
}

TEST(FrameRate, TimeIsTheExactQuotient) {
  EXPECT_EQ(FrameRate({24000, 1001}).seconds(24000), 1001.0);
  EXPECT_EQ(FrameRate{}.seconds(12), 0.5);
  EXPECT_EQ(FrameRate{}.seconds(-12), -0.5);
}

TEST(FramePattern, NumbersWithPercentAndHashes) {
  EXPECT_EQ(parse_pattern("a/%04d.exr")->name(7), "a/0007.exr");
  EXPECT_EQ(parse_pattern("a/%04d.exr")->name(12345), "a/12345.exr");
  EXPECT_EQ(parse_pattern("a/####.exr")->name(7), "a/0007.exr");
  EXPECT_EQ(parse_pattern("a/%d.exr")->name(7), "a/7.exr");
  EXPECT_EQ(parse_pattern("a/%03d.exr")->name(-7), "a/-007.exr");
  EXPECT_EQ(parse_pattern("100%%.exr")->name(7), "100%.exr");
  // One # is a number in a file's name, and a sign in a folder's.
  EXPECT_EQ(parse_pattern("o3#a/s.png")->name(7), "o3#a/s.png");
  EXPECT_EQ(parse_pattern("o3#a/s#.png")->name(7), "o3#a/s7.png");
  EXPECT_EQ(parse_pattern("shot_###/s{#}1.png")->name(7), "shot_007/s#1.png");
  EXPECT_FALSE(parse_pattern("plain.exr")->numbered);
  for (const char* text :
       {"%04d-%04d.exr", "##-##.exr", "%s.exr", "%4d.exr", "%", "%0", "%099d.exr", "$F4-####.exr", "{frame}-%d.exr",
        "{frme:04}.exr", "{frame:4}.exr", "{frame:}.exr", "{frame", "}.exr", "$F99.exr"})
    EXPECT_FALSE(parse_pattern(text)) << text;
}

TEST(FramePattern, NumbersWithBracesAndDollars) {
  EXPECT_EQ(parse_pattern("a/{frame:05}.exr")->name(7), "a/00007.exr");
  EXPECT_EQ(parse_pattern("a/{frame}.exr")->name(-7), "a/-7.exr");
  EXPECT_EQ(parse_pattern("a/$F4.exr")->name(7), "a/0007.exr");
  EXPECT_EQ(parse_pattern("a.$F.exr")->name(7), "a.7.exr");
  EXPECT_EQ(parse_pattern("$Four$.exr")->name(7), "$Four$.exr");
  EXPECT_EQ(parse_pattern("{{a}}.exr")->name(7), "{a}.exr");
  EXPECT_EQ(parse_pattern("{camera}-####.exr")->name(7, "100%{x}"), "100%{x}-0007.exr");
  EXPECT_TRUE(parse_pattern("{camera}.exr")->by_camera);
}

TEST(FramePattern, TellsTheFrameOfAName) {
  const FramePattern pattern = *parse_pattern("a/./b%04d.png");
  EXPECT_EQ(pattern.frame_of("a/b0007.png"), 7);
  EXPECT_EQ(pattern.frame_of("a/b12345.png"), 12345);
  for (const char* other : {"a/b7.png", "a/b0007.exr", "b0007.png", "a/b00x7.png", "a/b.png"})
    EXPECT_FALSE(pattern.frame_of(other)) << other;
  EXPECT_TRUE(may_share_names(*parse_pattern("a/%04d.png"), *parse_pattern("a/1%03d.png")));
  EXPECT_FALSE(may_share_names(*parse_pattern("a/%04d.png"), *parse_pattern("a/%04d.exr")));
  EXPECT_FALSE(may_share_names(*parse_pattern("a/%04d.png"), *parse_pattern("b/%04d.png")));
}

TEST(Shard, EveryFrameBelongsToExactlyOne) {
  const Frames all = parse_frame_list("0-22,100-140x7").value();
  for (const int count : {1, 2, 3, 7, 40}) {
    std::map<int64_t, int> seen;
    size_t largest = 0, smallest = all.size();
    for (int index = 1; index <= count; ++index) {
      const Frames mine = shard_of(all, {index, count});
      largest = std::max(largest, mine.size()), smallest = std::min(smallest, mine.size());
      for (const int64_t frame : mine) ++seen[frame];
    }
    EXPECT_EQ(seen.size(), all.size());
    for (const auto& [frame, times] : seen) EXPECT_EQ(times, 1) << frame;
    EXPECT_LE(largest - smallest, 1u);
  }
  for (const char* text : {"", "0/3", "4/3", "1", "1/", "/3", "1/0", "1/3x", "-1/3"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

TEST(OutputFormat, FollowsTheEnding) {
  EXPECT_EQ(output_format("a.EXR").value(), OutputFormat::exr);
  EXPECT_EQ(output_format("b.x/a.png").value(), OutputFormat::png);
  for (const char* text : {"a.jpg", "a", "exr", ".exr", "a.exr/"}) EXPECT_FALSE(output_format(text)) << text;
}

}  // namespace
}  // namespace candela
