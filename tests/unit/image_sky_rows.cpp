// Skies that are read by rows: as they are, or as means of what the image has no room for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "image/environment_file.h"
#include "image/exr.h"
#include "image/half.h"
#include "image/hdr.h"
#include "image/sky_rows.h"
#include "image/sky_texel.h"

namespace candela::image_sky_rows {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "-" + name);
}

// Smooth, with a sun of a few texels.
glm::vec3 radiance(int x, int y, int width, int height) {
  const double u = (x + 0.5) / width, v = (y + 0.5) / height;
  const bool sun = std::hypot(x - 0.7 * width, y - 0.3 * height) < 4;
  return sun ? glm::vec3(9e4f, 8e4f, 7e4f) : glm::vec3(0.5 + 0.4 * std::sin(40 * u), 0.3 + v * v, 1 - 0.5 * v);
}
void fill(int width, int height, int row, float* texels) {
  for (int x = 0; x < width; ++x) {
    const glm::vec3 r = radiance(x, row, width, height);
    texels[4 * x] = r.x, texels[4 * x + 1] = r.y, texels[4 * x + 2] = r.z, texels[4 * x + 3] = 1;
  }
}

// Sums of light: radiance times solid angle.
struct Light {
  glm::dvec3 all{0};
  void add(const float* texels, int width, int row, int height) {
    const double row_rad = std::numbers::pi / height;
    const double solid = 2 * std::numbers::pi / width * (std::cos(row_rad * row) - std::cos(row_rad * (row + 1)));
    for (int x = 0; x < width; ++x) all += solid * glm::dvec3(texels[4 * x], texels[4 * x + 1], texels[4 * x + 2]);
  }
};
Light light_of(const DecodedImage& image) {
  Light light;
  const auto* texels = reinterpret_cast<const float*>(image.pixels.data());
  for (int y = 0; y < image.height; ++y)
    light.add(texels + size_t(y) * size_t(image.width) * 4, image.width, y, image.height);
  return light;
}

TEST(SkyRows, LargeSkiesBecomeMeansOfTheSameLight) {
  struct Case {
    int width, height, made_width, made_height;
  };
  for (const Case& c :
       {Case{16384, 60, 8192, 30}, Case{10001, 61, 5000, 30}, Case{20000, 47, 6666, 15}, Case{64, 4100, 32, 2050}}) {
    SkyMeans means("sky", 0);
    ASSERT_TRUE(means.begin({c.width, c.height, 3, 32}));
    Light before;
    std::vector<float> row(size_t(c.width) * 4);
    for (int y = 0; y < c.height; ++y) {
      fill(c.width, c.height, y, row.data());
      before.add(row.data(), c.width, y, c.height);
    }
    // Strips that end within a row of the image.
    for (int first = 0; first < c.height; first += 7)
      means.add(first, std::min(7, c.height - first),
                [&](int y, float* texels) { fill(c.width, c.height, y, texels); });
    std::vector<std::string> warnings;
    const DecodedImage image = means.finish(warnings);
    EXPECT_EQ(image.width, c.made_width);
    EXPECT_EQ(image.height, c.made_height);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(fmt::format("is {}x{}", c.width, c.height)), std::string::npos) << warnings[0];
    const Light after = light_of(image);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(after.all[i] / before.all[i], 1, 2e-6) << c.width << "x" << c.height << " channel " << i;
    for (size_t i = 0; i < image.pixels.size() / 16; ++i) {
      const SkyTexel t = sky_texel(image, i);
      ASSERT_TRUE(t[2] >= 0.5f - 1e-5f && t[3] == 1);  // the least of what it is made of
    }
  }
}

// Rows of files, whichever way they are stored, are what the whole file holds.
TEST(SkyRows, SmallSkiesAreAsTheyAre) {
  constexpr int width = 40, height = 300;
  FloatImage image{.width = width, .height = height};
  for (const char* name : {"B", "G", "R"}) image.channels.push_back({name, ChannelType::float32, {}, {}});
  std::vector<float> row(width * 4);
  for (int y = 0; y < height; ++y) {
    fill(width, height, y, row.data());
    for (size_t x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c) image.channels[c].f.push_back(row[4 * x + 2 - c]);
  }
  for (const ExrCompression compression : {ExrCompression::none, ExrCompression::zip, ExrCompression::piz}) {
    const auto path = temporary("rows.exr");
    ASSERT_TRUE(write_exr(path, image, compression));
    std::vector<std::string> warnings;
    const auto sky = read_environment(path, warnings);
    ASSERT_TRUE(sky) << sky.error().text();
    EXPECT_TRUE(warnings.empty());
    ASSERT_EQ(sky->pixels.size(), size_t(width * height * 16));
    for (size_t i = 0; i < size_t(width * height); ++i)
      for (size_t c = 0; c < 3; ++c) ASSERT_EQ(sky_texel(*sky, i)[int(c)], image.channels[2 - c].f[i]) << i;
    // Cut anywhere it is an error.
    std::filesystem::resize_file(path, std::filesystem::file_size(path) * 3 / 4);
    EXPECT_FALSE(read_environment(path, warnings));
    std::filesystem::remove(path);
  }
  for (const char* head : {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 300 +X 40\n", "#?RADIANCE\n\n+Y 300 -X 40\n"}) {
    std::string bytes = head;
    for (int i = 0; i < width * height; ++i)
      for (const int value : {100 + i % 90, i % 200, (i / width) % 256, 120 + i % 20}) bytes += char(value);
    const auto whole = decode_hdr(std::as_bytes(std::span(bytes)), "hdr", 4096);
    ASSERT_TRUE(whole) << whole.error().text();
    const auto path = temporary("rows.hdr");
    std::ofstream(path, std::ios::binary) << bytes;
    std::vector<std::string> warnings;
    const auto sky = read_environment(path, warnings);
    ASSERT_TRUE(sky) << sky.error().text();
    EXPECT_EQ(sky->pixels, whole->pixels) << head;
    std::filesystem::resize_file(path, bytes.size() - 5);
    const auto cut = read_environment(path, warnings);
    ASSERT_FALSE(cut);
    EXPECT_NE(cut.error().text().find("line 299 of 300 is truncated"), std::string::npos) << cut.error().text();
    std::filesystem::remove(path);
  }
}

TEST(SkyRows, TheBudgetCountsWhatIsKept) {
  EXPECT_EQ(sky_bytes(1024, 512), uint64_t(1024 * 512 * 16) / 3 * 4);
  EXPECT_EQ(sky_bytes(8192, 4096), uint64_t(768) << 20);
  SkyMeans means("large.exr", uint64_t(3400) << 20);
  const auto over = means.begin({16384, 8192, 3, 32});
  ASSERT_FALSE(over);
  EXPECT_NE(over.error().text().find("large.exr: decoded it takes 768 MiB"), std::string::npos) << over.error().text();
}

TEST(Half, NearestTiesToEven) {
  for (uint32_t h = 0; h < 65536; ++h) {
    const float value = half_to_float(uint16_t(h));
    if (std::isnan(value)) continue;
    ASSERT_EQ(float_to_half(value), h);
    if ((h & 0x7c00) == 0x7c00 || (h & 0x7fff) == 0x7bff) continue;
    const float next = half_to_float(uint16_t(h + 1)), middle = 0.5f * (value + next);
    ASSERT_EQ(float_to_half(middle), h & 1 ? h + 1 : h) << h;
    ASSERT_EQ(float_to_half(std::nextafter(middle, value)), h) << h;
    ASSERT_EQ(float_to_half(std::nextafter(middle, next)), h + 1) << h;
  }
  EXPECT_EQ(float_to_half(65519.0f), 0x7bff);
  EXPECT_EQ(float_to_half(65520.0f), 0x7c00);
  EXPECT_EQ(float_to_half(-1e30f), 0xfc00);
}

}  // namespace
}  // namespace candela::image_sky_rows
