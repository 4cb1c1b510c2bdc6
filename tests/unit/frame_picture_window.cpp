// Where the pixels of a job's files lie: regions and overscan.
#include <gtest/gtest.h>

#include "job/job.h"
#include "job/picture_window.h"

namespace candela {
namespace {

Job of_size(int width, int height) {
  Job job;
  job.width_px = width, job.height_px = height;
  return job;
}

TEST(PictureWindow, IsTheDisplayWindowWithoutBoth) {
  const PictureWindow w = picture_window(of_size(64, 48));
  EXPECT_EQ(w.part, (PixelRect{0, 0, 64, 48}));
  EXPECT_TRUE(w.is_plain() && w.is_whole());
}

TEST(PictureWindow, OverscanReachesBeyondOnEachSide) {
  Job job = of_size(101, 50);
  job.overscan = {3, false};
  const PictureWindow px = picture_window(job);
  EXPECT_EQ(px.data, (PixelRect{-3, -3, 107, 56}));
  EXPECT_EQ(px.part, (PixelRect{0, 0, 107, 56}));
  EXPECT_TRUE(px.is_whole() && !px.is_plain());
  job.overscan = {10, true};  // of 101 pixels 10.1: no less is rendered than was asked for
  EXPECT_EQ(picture_window(job).data, (PixelRect{-11, -5, 123, 60}));
}

TEST(PictureWindow, RegionsAreFromTheDisplayWindowsCorner) {
  Job job = of_size(100, 50);
  job.overscan = {10, false};
  job.region = PixelRect{-10, 40, 20, 20};
  const PictureWindow w = picture_window(job);
  EXPECT_EQ(w.data, *job.region);
  EXPECT_EQ(w.part, (PixelRect{0, 50, 20, 20}));
  EXPECT_FALSE(w.is_whole());
  EXPECT_TRUE(check_window(job));
}

TEST(PictureWindow, RefusesWhatReachesBeyondThePicture) {
  Job job = of_size(100, 50);
  for (const PixelRect& r : {PixelRect{-1, 0, 10, 10}, PixelRect{0, 0, 101, 10}, PixelRect{95, 45, 5, 6},
                             PixelRect{0, 0, 0, 10}, PixelRect{0, 0, 10, -1}}) {
    job.region = r;
    const auto checked = check_window(job);
    ASSERT_FALSE(checked) << r.x << "," << r.y;
    EXPECT_EQ(checked.error().place, "--region");
  }
  job.region.reset();
  job.overscan = {20000, false};
  EXPECT_EQ(check_window(job).error().place, "--overscan");
}

TEST(PictureWindow, ReadsTexts) {
  EXPECT_EQ(*parse_pixel_rect("-4,5,6,7"), (PixelRect{-4, 5, 6, 7}));
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5", "1,2,3,x", "1,2,3,4 ", "1.5,2,3,4", "99999999999,0,1,1"})
    EXPECT_FALSE(parse_pixel_rect(wrong)) << wrong;
  EXPECT_EQ(*parse_overscan("64"), (Overscan{64, false}));
  EXPECT_EQ(*parse_overscan("7.5%"), (Overscan{7.5, true}));
  for (const char* wrong : {"", "%", "-1", "1.5", "nan", "inf%", "10%%", "ten"})
    EXPECT_FALSE(parse_overscan(wrong)) << wrong;
  EXPECT_EQ(*parse_light_group("key=Sun,Lamp*"), (LightGroupRequest{"key", {"Sun", "Lamp*"}}));
  for (const char* wrong : {"", "key", "key=", "=Sun"}) EXPECT_FALSE(parse_light_group(wrong)) << wrong;
}

TEST(PictureWindow, GrownPartsAreOfWholeTilesWithinThePicture) {
  EXPECT_EQ(grown({70, 130, 10, 10}, 8, 64, 200, 150), (PixelRect{0, 64, 128, 86}));
  EXPECT_EQ(grown({0, 0, 200, 150}, 8, 64, 200, 150), (PixelRect{0, 0, 200, 150}));
}

}  // namespace
}  // namespace candela
