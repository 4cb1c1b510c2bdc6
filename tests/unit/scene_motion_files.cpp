#include "scene/motion_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "scene/drawn_sections.h"

namespace candela::test::scene_motion_files {
class MotionFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("motion-") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const std::string& text) const {
    std::ofstream(folder_ / "file.txt", std::ios::binary) << text;
    return folder_ / "file.txt";
  }
  // Behind the folder's name.
  std::string error_of(const auto& read) const {
    if (read) return "";
    const std::string text = read.error().text(), folder = folder_.string() + "/";
    return text.starts_with(folder) ? text.substr(folder.size()) : text;
  }
  std::filesystem::path folder_;
};

using InstanceFiles = MotionFiles;

TEST_F(MotionFiles, PointsAreLinesOfThreeNumbers) {
  const auto points = read_points(file("# a path\n1 2 3\n\n  -4.5e-1\t+5 6 # here\r\n0 0 0"));
  ASSERT_TRUE(points) << points.error().text();
  ASSERT_EQ(points->size(), 3u);
  EXPECT_EQ((*points)[0], glm::dvec3(1, 2, 3));
  EXPECT_EQ((*points)[1], glm::dvec3(-0.45, 5, 6));
}

TEST_F(MotionFiles, TheFirstMalformedLineIsNamed) {
  const std::string what = "; a point is three numbers: x y z";
  EXPECT_EQ(error_of(read_points(file("1 2 3\n4 5\n"))), "file.txt:2: the line holds 2 numbers" + what);
  EXPECT_EQ(error_of(read_points(file("1 2 3 4\n"))), "file.txt:1: the line holds 4 numbers" + what);
  EXPECT_EQ(error_of(read_points(file("#\n\n1 x 3\n"))), "file.txt:3: 'x' is not a number" + what);
  EXPECT_EQ(error_of(read_points(file("1 2 nan\n"))), "file.txt:1: 'nan' is not a number" + what);
  EXPECT_EQ(error_of(read_points(file("1 2 1e999\n"))), "file.txt:1: '1e999' is not a number" + what);
  EXPECT_EQ(error_of(read_points(file("1,2,3\n"))), "file.txt:1: '1,2,3' is not a number" + what);
  EXPECT_EQ(error_of(read_points(file("1 2 3\n\x01\xff\n"))), "file.txt:2: '??' is not a number" + what);
  EXPECT_EQ(error_of(read_points(file("# nothing\n"))), "file.txt: holds no numbers" + what);
  EXPECT_NE(error_of(read_points(folder_ / "absent.txt")), "");
}

TEST_F(MotionFiles, TimesOutOfOrderAreRefusedWithTheirLine) {
  const auto times = read_times(file("0 0\n1.5 2\n4 2\n"));
  ASSERT_TRUE(times) << times.error().text();
  EXPECT_EQ(times->time_s, (std::vector<double>{0, 1.5, 4}));
  EXPECT_EQ(times->parameter, (std::vector<double>{0, 2, 2}));
  EXPECT_EQ(error_of(read_times(file("0 0\n\n2 1\n1 2\n"))),
            "file.txt:4: the time 1 s comes before 2 s; times must ascend");
  const auto jump = read_times(file("0 0\n1 1\n1 3\n2 4\n"));
  ASSERT_TRUE(jump) << jump.error().text();
  EXPECT_EQ(jump->jumps_s(), std::vector<double>{1});
  EXPECT_EQ(
      error_of(read_times(file("0 0\n1 1\n1 2\n1 3\n"))),
      "file.txt:4: the time 1 s is given a third time; two lines of one time are a jump from one parameter to another");
  EXPECT_NE(error_of(read_times(file("0\n"))).find("file.txt:1: the line holds 1 number;"), std::string::npos);
}

// M = T R S, with matrices from their definitions.
TEST_F(InstanceFiles, AreMatricesOfScaleRotationAndTranslation) {
  const glm::dvec3 scale(2, 0.5, 3), degrees(20, -35, 110), translation(4, 5, -6);
  const auto about = [](int axis, double radians) {
    const double c = std::cos(radians), s = std::sin(radians);
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    glm::dmat3 m(1);
    m[i][i] = c, m[i][j] = s, m[j][i] = -s, m[j][j] = c;
    return m;
  };
  for (const std::string rotation : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"})
    for (const std::string order : {"srt", "str", "rst", "rts", "tsr", "trs"})
      for (const bool radians : {false, true})
        for (const char* between : {"\n", " "}) {
          std::string text;
          const glm::dvec3 angles = radians ? degrees * (std::numbers::pi / 180) : degrees;
          for (const char what : order) {
            const glm::dvec3 v = what == 's' ? scale : what == 'r' ? angles : translation;
            text += fmt::format("{} {} {}{}", v.x, v.y, v.z, between);
          }
          const auto read =
              read_instances(file(text + "\n"), {.rotation = rotation, .radians = radians, .order = order});
          ASSERT_TRUE(read) << read.error().text();
          ASSERT_EQ(read->count, 1u);
          glm::dmat3 r(1);
          for (const char axis : rotation) r = r * about(axis - 'x', degrees[axis - 'x'] * std::numbers::pi / 180);
          const glm::dmat4 m = node_from_instance(*read, 0);
          for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length(glm::dvec3(m[c]) - r[c] * scale[c]), 1e-6) << rotation;
          EXPECT_EQ(glm::dvec3(m[3]), translation);
        }
}

TEST_F(InstanceFiles, ThousandsAreRead) {
  std::string text = "# scale, rotation, translation\n";
  for (int i = 0; i < 5000; ++i) text += fmt::format("1 1 {}\n0 {} 0\n{} 0 0\n\n", i + 1, i, 2 * i);
  const auto read = read_instances(file(text), {});
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->count, 5000u);
  EXPECT_EQ(read->scale[4999], glm::vec3(1, 1, 5000));
  EXPECT_EQ(read->translation[4999], glm::vec3(9998, 0, 0));
}

TEST_F(InstanceFiles, MalformedGroupsNameTheirLine) {
  const std::string what = "; an instance is three lines of three numbers, or nine numbers in one";
  EXPECT_EQ(error_of(read_instances(file("1 1 1\n0 0 0\n0 0 0\n1 1 1\n0 0 0\n"), {})),
            "file.txt:4: the last instance has 2 of its 3 vectors" + what);
  EXPECT_EQ(error_of(read_instances(file("1 1 1\n1 1 1 0 0 0 0 0 0\n"), {})),
            "file.txt:2: the line holds nine numbers, within the instance that begins in line 1" + what);
  EXPECT_EQ(error_of(read_instances(file("1 1 1\n0 0 0\n0 0\n"), {})), "file.txt:3: the line holds 2 numbers" + what);
  EXPECT_EQ(error_of(read_instances(file("1 1 1\n0 0 0\n0 0 1e99\n"), {})),
            "file.txt:1: the instance holds a number beyond what 32 bits hold");
}

}  // namespace candela::test::scene_motion_files
