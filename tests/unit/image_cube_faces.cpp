#include "image/cube_faces.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <numbers>

namespace candela {
namespace {

namespace fs = std::filesystem;

class CubeFaces : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(::testing::TempDir()) / fmt::format("faces_{}", info->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  // Every face of one colour.
  void write(const std::string& name, glm::vec3 colour, int width = 16, int height = 16) const {
    FloatImage image;
    image.width = width, image.height = height;
    for (int c = 0; c < 3; ++c)
      image.channels.push_back(
          {std::string(1, "RGB"[c]), ChannelType::float32, std::vector<float>(size_t(width * height), colour[c]), {}});
    ASSERT_TRUE(write_exr(folder / name, image));
  }
  fs::path folder;
};

glm::vec3 towards(const DecodedImage& image, glm::dvec3 d) {
  d = glm::normalize(d);
  const int x = int((std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5) * image.width) % image.width;
  const int y = std::min(int(std::acos(d.y) / std::numbers::pi * image.height), image.height - 1);
  glm::vec3 out;
  std::memcpy(&out, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 12);
  return out;
}

}  // namespace

TEST_F(CubeFaces, LieWhereTheirNamesSay) {
  const char* names[] = {"px.exr", "nx.exr", "py.exr", "ny.exr", "pz.exr", "nz.exr"};
  for (int i = 0; i < 6; ++i) write(names[i], glm::vec3(float(i), 1, 2));
  const auto image = read_environment(folder);
  ASSERT_TRUE(image) << image.error().text();
  EXPECT_EQ(image->width, 64);
  EXPECT_EQ(image->height, 32);
  for (int i = 0; i < 6; ++i) {
    glm::dvec3 d(0.1, 0.05, 0.07);
    d[i / 2] = i % 2 ? -1 : 1;
    EXPECT_EQ(towards(*image, d), glm::vec3(float(i), 1, 2)) << i;
  }
}

// A face brighter to the right and below: which way is right and down inside each, as Vulkan has it.
TEST_F(CubeFaces, AreTurnedAsVulkansCubeMaps) {
  constexpr int side = 32;
  FloatImage ramp;
  ramp.width = ramp.height = side;
  ramp.channels = {
      {"R", ChannelType::float32, {}, {}}, {"G", ChannelType::float32, {}, {}}, {"B", ChannelType::float32, {}, {}}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      ramp.channels[0].f.push_back(float(x + 0.5) / side);
      ramp.channels[1].f.push_back(float(y + 0.5) / side);
      ramp.channels[2].f.push_back(0);
    }
  for (const char* name :
       {"sky_right.exr", "sky_left.exr", "sky_top.exr", "sky_bottom.exr", "sky_front.exr", "sky_back.exr"})
    ASSERT_TRUE(write_exr(folder / name, ramp));
  for (const fs::path& named : {folder, folder / "sky_*.exr"}) {
    const auto image = read_environment(named);
    ASSERT_TRUE(image) << image.error().text();
    // Directions that show u 0.75 and v 0.5, then u 0.5 and v 0.75.
    const glm::dvec3 right[] = {{1, 0, -0.5}, {-1, 0, 0.5}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, 1}, {-0.5, 0, -1}};
    const glm::dvec3 below[] = {{1, -0.5, 0}, {-1, -0.5, 0}, {0, 1, 0.5}, {0, -1, -0.5}, {0, -0.5, 1}, {0, -0.5, -1}};
    for (int i = 0; i < 6; ++i) {
      EXPECT_NEAR(towards(*image, right[i]).x, 0.75, 0.03) << i;
      EXPECT_NEAR(towards(*image, right[i]).y, 0.5, 0.03) << i;
      EXPECT_NEAR(towards(*image, below[i]).x, 0.5, 0.03) << i;
      EXPECT_NEAR(towards(*image, below[i]).y, 0.75, 0.03) << i;
    }
  }
}

TEST_F(CubeFaces, EightBitsAreSrgb) {
  const DisplayImage grey{4, 4, 3, 8, std::vector<std::byte>(48, std::byte(128))};
  for (const char* name : {"rt", "lf", "up", "dn", "ft", "bk"})
    ASSERT_TRUE(write_png(folder / (std::string(name) + ".png"), grey));
  const auto image = read_environment(folder);
  ASSERT_TRUE(image) << image.error().text();
  EXPECT_NEAR(towards(*image, {1, 0.2, 0}).x, 0.2158605f, 1e-5);
}

TEST_F(CubeFaces, ErrorsNameWhatIsWrong) {
  EXPECT_NE(read_environment(folder).error().text().find("no face"), std::string::npos);
  for (const char* name : {"px.exr", "nx.exr", "py.exr", "ny.exr", "pz.exr"}) write(name, glm::vec3(1));
  EXPECT_NE(read_environment(folder).error().text().find("six faces of a sky: nz"), std::string::npos);
  write("nz.exr", glm::vec3(1), 16, 8);
  EXPECT_NE(read_environment(folder).error().text().find("nz.exr"), std::string::npos);
  EXPECT_NE(read_environment(folder).error().text().find("square"), std::string::npos);
  write("nz.exr", glm::vec3(1), 8, 8);
  EXPECT_NE(read_environment(folder).error().text().find("alike"), std::string::npos);
}

}  // namespace candela
