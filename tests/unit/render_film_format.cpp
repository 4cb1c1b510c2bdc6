#include "render/film_format.h"

#include <gtest/gtest.h>

#include "render/film_pictures.h"

namespace candela {
namespace {

TEST(FilmFormat, EndingsSayTheCodecAndWhichTheyHold) {
  EXPECT_EQ((*film_codec({.path = "a.mp4"}))->name, "h264");
  EXPECT_EQ((*film_codec({.path = "a.WEBM"}))->name, "vp9");
  EXPECT_EQ((*film_codec({.path = "a.mov", .codec = "prores4444"}))->name, "prores4444");
  EXPECT_FALSE(film_codec({.path = "a.avi"}));
  EXPECT_FALSE(film_codec({.path = "a.webm", .codec = "h264"}));
  EXPECT_FALSE(film_codec({.path = "a.mp4", .codec = "ffv1"}));
  EXPECT_FALSE(film_codec({.path = "a.mp4", .codec = "h246"}));
}

TEST(FilmFormat, OddSidesAreRefusedWithThoseThatWork) {
  const auto odd = check_film_size({.path = "a.mp4"}, 321, 181);
  ASSERT_FALSE(odd);
  EXPECT_NE(odd.error().message.find("take 320x180 or 322x182"), std::string::npos) << odd.error().message;
  EXPECT_FALSE(check_film_size({.path = "a.mkv", .codec = "h265"}, 320, 181));
  EXPECT_TRUE(check_film_size({.path = "a.mp4", .pad = true}, 321, 181));
  EXPECT_TRUE(check_film_size({.path = "a.mov", .codec = "prores"}, 321, 181));
  EXPECT_TRUE(check_film_size({.path = "a.mp4"}, 320, 180));
}

TEST(FilmPictures, NumbersThatAreMissing) {
  EXPECT_EQ(missing_numbers({}), "");
  EXPECT_EQ(missing_numbers({7}), "");
  EXPECT_EQ(missing_numbers({0, 2, 4}), "");
  EXPECT_EQ(missing_numbers({0, 1, 3, 7}), "2, 4-6");
  EXPECT_EQ(missing_numbers({0, 2, 7}), "4-6x2");
  EXPECT_EQ(missing_numbers({-2, -1, 1}), "0");
}

}  // namespace
}  // namespace candela
