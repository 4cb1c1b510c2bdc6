#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "base/files.h"
#include "image/io.h"

namespace candela::image_write {
namespace {

std::filesystem::path temporary(const std::string& name) { return std::filesystem::path(testing::TempDir()) / name; }

bool has_module() { return std::filesystem::exists(program_folder() / "candela_oiio.so"); }

DisplayImage gradient(int channels, int bits) {
  DisplayImage image{.width = 19, .height = 7, .channels = channels, .bits = bits};
  for (int i = 0; i < 19 * 7 * channels; ++i) {
    const auto code = uint16_t(i * 487);
    image.pixels.push_back(std::byte(code & 255));
    if (bits == 16) image.pixels.push_back(std::byte(code >> 8));
  }
  return image;
}

// Codes come back as they went in, alpha straight, marked as sRGB, and two writes give the same bytes.
TEST(Png, RoundTrip) {
  const auto path = temporary("round_trip.png");
  for (const int channels : {3, 4})
    for (const int bits : {8, 16}) {
      const DisplayImage image = gradient(channels, bits);
      const auto written = write_png(path, image);
      ASSERT_TRUE(written) << written.error().text();
      const auto bytes = read_file(path);
      ASSERT_TRUE(write_png(path, image));
      EXPECT_EQ(*bytes, *read_file(path));
      const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
      for (const char* stamp : {"tIME", "Date", "Software"})
        EXPECT_EQ(text.find(stamp), std::string_view::npos) << stamp;
      EXPECT_NE(text.find(std::string_view("\0\0\0\1sRGB", 8)), std::string_view::npos);
      const auto back = decode_image(*bytes, "back");
      ASSERT_TRUE(back) << back.error().text();
      EXPECT_EQ(back->source_channels, channels);
      const size_t size = size_t(bits / 8);
      for (size_t i = 0; i < 19 * 7; ++i)
        ASSERT_EQ(std::memcmp(&back->pixels[i * 4 * size], &image.pixels[i * size_t(channels) * size],
                              size * size_t(channels)),
                  0)
            << channels << " channels, " << bits << " bits, pixel " << i;
    }
  std::filesystem::remove(path);
}

TEST(ReadImage, OtherFormatsGoThroughTheModule) {
  if (!has_module()) GTEST_SKIP() << "candela_oiio.so is not built";
  const auto path = temporary("two.ppm");
  std::ofstream(path) << "P3 2 1 255\n255 0 51  0 255 102\n";
  const auto image = read_image(path);
  ASSERT_TRUE(image) << image.error().text();
  ASSERT_NE(image->find("B"), nullptr);
  EXPECT_NEAR(image->find("B")->f[0], 0.2f, 1e-6);
  EXPECT_NEAR(image->find("B")->f[1], 0.4f, 1e-6);
  std::ofstream(path) << "nothing that any format knows";
  const auto broken = read_image(path);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().kind, ErrorKind::input);
  std::filesystem::remove(path);
}

// What `differing` counts between a PNG and a TIFF of the same picture is 0.
TEST(ReadImage, CodesAreTheSameNumberInEveryFormat) {
  if (!has_module()) GTEST_SKIP() << "candela_oiio.so is not built";
  const auto path = temporary("codes.ppm");
  {
    std::ofstream file(path);
    file << "P2 256 1 255\n";
    for (int code = 0; code < 256; ++code) file << code << " ";
  }
  const auto image = read_image(path);
  ASSERT_TRUE(image) << image.error().text();
  ASSERT_EQ(image->width, 256);
  for (int code = 0; code < 256; ++code) ASSERT_EQ(image->channels[0].f[size_t(code)], float(code) / 255.0f) << code;
  std::filesystem::remove(path);
}

FloatImage noise(int side) {
  FloatImage image{.width = side, .height = side};
  image.channels = {{"R", ChannelType::float32}};
  uint32_t state = 1;
  for (int i = 0; i < side * side; ++i)
    image.channels[0].f.push_back(float((state = state * 1664525u + 1013904223u) >> 8));
  return image;
}

void expect_output_error_and_no_file(const Expected<void>& written, const std::filesystem::path& folder) {
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::output);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

// The file size limit makes write() fail as a full disk does. In a child, as the limit holds for the whole process.
// "threadsafe": the child starts anew, so OpenEXR's threads of earlier tests are not missing in it.
TEST(FullDisk, SizeLimitGivesOutputErrorAndLeavesNothing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto folder = temporary("size_limit");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto write_on_full_disk = [&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{65536, 65536};
    setrlimit(RLIMIT_FSIZE, &limit);
    const auto written = write_exr(folder / "image.exr", noise(300));
    _exit(!written && written.error().kind == ErrorKind::output && std::filesystem::is_empty(folder) ? 0 : 1);
  };
  EXPECT_EXIT(write_on_full_disk(), testing::ExitedWithCode(0), "");
  std::filesystem::remove_all(folder);
}

TEST(FullDisk, TinyTmpfsGivesOutputErrorAndLeavesNothing) {
  const auto folder = temporary("tiny_disk");
  std::filesystem::create_directories(folder);
  if (geteuid() != 0 || mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "a tmpfs cannot be mounted here";
  expect_output_error_and_no_file(write_exr(folder / "image.exr", noise(300)), folder);
  EXPECT_TRUE(write_exr(folder / "small.exr", noise(8)));
  umount(folder.c_str());
  std::filesystem::remove_all(folder);
}

TEST(Write, AbsentFolderIsAnOutputError) {
  const auto written = write_exr(temporary("no_such_folder/image.exr"), noise(4));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::output);
}

}  // namespace
}  // namespace candela::image_write
