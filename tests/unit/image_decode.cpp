#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "../png_checksums.h"
#include "base/files.h"
#include "image/exr.h"
#include "image/io.h"

namespace candela::image_decode {
namespace {

const std::filesystem::path assets = CANDELA_SOURCE_DIR "/../shared/assets";
std::filesystem::path temporary(const std::string& name) { return std::filesystem::path(testing::TempDir()) / name; }
std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// A PNG of our own, from stored (uncompressed) deflate blocks, so that every colour type and depth can be made.
std::string be32(uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }
std::string chunk(const std::string& type, const std::string& data) {
  std::string body = type + data;
  uint32_t crc = 0xffffffffu;
  for (const char c : body) {
    crc ^= uint8_t(c);
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
  }
  return be32(uint32_t(data.size())) + body + be32(~crc);
}
std::string png(uint32_t width, uint32_t height, int bits, int colour_type, const std::string& rows,
                const std::string& extra = "") {
  uint32_t a = 1, b = 0;
  for (const char c : rows) a = (a + uint8_t(c)) % 65521, b = (b + a) % 65521;
  const auto size = uint16_t(rows.size());
  std::string stream = "\x78\x01\x01";
  stream += {char(size & 255), char(size >> 8), char(~size & 255), char((~size >> 8) & 255)};
  stream += rows + be32(b << 16 | a);
  return std::string("\x89PNG\r\n\x1a\n", 8) +
         chunk("IHDR", be32(width) + be32(height) + std::string{char(bits), char(colour_type), 0, 0, 0}) + extra +
         chunk("IDAT", stream) + chunk("IEND", "");
}

std::vector<uint8_t> codes8(const DecodedImage& image) {
  std::vector<uint8_t> codes(image.pixels.size());
  std::memcpy(codes.data(), image.pixels.data(), codes.size());
  return codes;
}

TEST(Decode, GreyPaletteAndColourBecomeRgba8) {
  using Codes = std::vector<uint8_t>;
  auto grey = decode_image(bytes_of(png(2, 1, 8, 0, std::string("\0\x10\x20", 3))), "grey");
  ASSERT_TRUE(grey) << grey.error().text();
  EXPECT_EQ(codes8(*grey), (Codes{16, 16, 16, 255, 32, 32, 32, 255}));
  EXPECT_EQ(grey->source_channels, 1);
  auto grey_alpha = decode_image(bytes_of(png(1, 1, 8, 4, std::string("\0\x10\x20", 3))), "grey alpha");
  ASSERT_TRUE(grey_alpha);
  EXPECT_EQ(codes8(*grey_alpha), (Codes{16, 16, 16, 32}));
  const std::string palette = chunk("PLTE", "abcdef") + chunk("tRNS", "\x7f");
  auto indexed = decode_image(bytes_of(png(2, 1, 8, 3, std::string("\0\1\0", 3), palette)), "palette");
  ASSERT_TRUE(indexed) << indexed.error().text();
  EXPECT_EQ(codes8(*indexed), (Codes{'d', 'e', 'f', 255, 'a', 'b', 'c', 127}));
  auto one_bit = decode_image(bytes_of(png(3, 1, 1, 0, std::string("\0\xa0", 2))), "one bit");
  ASSERT_TRUE(one_bit);
  EXPECT_EQ(codes8(*one_bit)[0] + codes8(*one_bit)[4] + codes8(*one_bit)[8], 510);
}

TEST(Decode, SixteenBitsStaySixteen) {
  const std::string file = png(1, 1, 16, 2, std::string("\0\x12\x34\xab\xcd\0\1", 7));
  const auto info = probe_image(bytes_of(file), "deep");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->bits, 16);
  EXPECT_EQ(info->channels, 3);
  const auto image = decode_image(bytes_of(file), "deep");
  ASSERT_TRUE(image);
  ASSERT_EQ(image->format, DecodedImage::Format::rgba16);
  std::array<uint16_t, 4> codes;
  ASSERT_EQ(image->pixels.size(), 8u);
  std::memcpy(codes.data(), image->pixels.data(), 8);
  EXPECT_EQ(codes, (std::array<uint16_t, 4>{0x1234, 0xabcd, 1, 0xffff}));
}

TEST(Decode, SizesAreRefused) {
  const std::string good = png(2, 1, 8, 0, std::string("\0\x10\x20", 3));
  EXPECT_TRUE(decode_image(bytes_of(good), "good", 2));
  for (const auto& [file, side] :
       {std::pair(good, 1), std::pair(png(9000, 9000, 8, 6, "x"), 16384), std::pair(png(0, 4, 8, 6, "x"), 16384)}) {
    const auto image = decode_image(bytes_of(file), "the image", side);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().kind, ErrorKind::input);
    EXPECT_TRUE(image.error().text().starts_with("the image: "));
  }
}

std::vector<std::string> stored_files() {
  std::vector<std::string> files;
  for (const char* name :
       {"uastc_modes.ktx2", "etc1s_alpha.ktx2", "etc1s_58x42.ktx2", "lossless.webp", "lossy_alpha.webp"}) {
    const auto bytes = read_file(std::filesystem::path(CANDELA_SOURCE_DIR) / "tests/images" / name);
    EXPECT_TRUE(bytes) << name;
    if (bytes) files.emplace_back(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  }
  return files;
}

TEST(Decode, EveryTruncationIsAnError) {
  std::vector<std::string> files = stored_files();
  files.push_back(png(4, 4, 8, 2, std::string(4 * 13, '\0')));
  files.push_back("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n" + std::string("\2\2\0\x09", 4) +
                  std::string("\x89\x80\x89\x80\x89\x80\x89\x80", 8) + std::string("\2\2\0\x09", 4) +
                  std::string("\x89\x80\x89\x80\x89\x80\x89\x81", 8));
  if (const auto jpeg = assets / "khronos"; std::filesystem::exists(jpeg))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(jpeg))
      if (entry.path().extension() == ".jpg") {
        const auto bytes = read_file(entry.path());
        ASSERT_TRUE(bytes);
        files.emplace_back(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        break;
      }
  for (const std::string& file : files) {
    ASSERT_TRUE(decode_image(bytes_of(file), "whole")) << decode_image(bytes_of(file), "whole").error().text();
    for (size_t length = 0; length < file.size(); length += 1 + length / 20)
      EXPECT_FALSE(decode_image(bytes_of(std::string_view(file).substr(0, length)), "cut"))
          << length << " of " << file.size();
  }
}

// Every byte of a PNG's head and pixels counts: one bit that is another is an error, not other pixels.
TEST(Decode, EveryDamagedBitOfAPngIsAnError) {
  const auto small = read_file(std::filesystem::path(CANDELA_SOURCE_DIR) / "tests/images/etc1s_58x42.png");
  ASSERT_TRUE(small);
  std::vector<std::byte> bytes = *small;
  for (size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= std::byte(1 << i % 8);
    EXPECT_FALSE(decode_image(bytes, "damaged")) << "byte " << i;
    bytes[i] = (*small)[i];
  }
  EXPECT_TRUE(decode_image(bytes, "whole"));
  // Fewer rows than the head says, in chunks that are whole.
  EXPECT_FALSE(decode_image(bytes_of(png(4, 4, 8, 2, std::string(3 * 13, '\0'))), "short"));
}

TEST(Decode, MutatedBytesNeverCrash) {
  std::vector<std::string> files = {png(8, 8, 8, 6, std::string(8 * 33, '\1')),
                                    png(5, 5, 4, 3, std::string(5 * 4, '\0'), chunk("PLTE", "abcdefghi")),
                                    "#?RGBE\n\n-Y 3 +X 2\n" + std::string(24, '\x80')};
  for (std::string& file : stored_files()) files.push_back(std::move(file));
  if (const auto folder = assets / "khronos"; std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.path().extension() == ".jpg" && entry.file_size() < 30000) {
        const auto bytes = read_file(entry.path());
        files.emplace_back(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        break;
      }
  uint32_t state = 99;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const std::string& good : files)
    for (int round = 0; round < 400; ++round) {
      std::string bytes = good;
      for (uint32_t n = 1 + random() % 6; n > 0; --n) bytes[random() % bytes.size()] = char(random());
      // An exact heap block: reading past it is seen by the address sanitizer.
      std::vector<char> exact(bytes.begin(), bytes.end());
      test::renew_png_checksums(std::as_writable_bytes(std::span(exact)));
      const auto image = decode_image(std::as_bytes(std::span(exact)), "mutated", 2048);
      if (image) {
        const size_t size = image->format == DecodedImage::Format::rgba8    ? 4
                            : image->format == DecodedImage::Format::rgba16 ? 8
                                                                            : 16;
        EXPECT_EQ(image->pixels.size(), size_t(image->width) * size_t(image->height) * size);
      } else {
        EXPECT_EQ(image.error().kind, ErrorKind::input);
      }
    }
}

// Only the sizes in the header and the length of the file count: 4096x4096 pixels are free, more need a byte for 64.
TEST(Decode, ManyPixelsFromFewBytesAreRefused) {
  const auto file = [](uint32_t width, uint32_t height, size_t length) {
    const std::string head = png(width, height, 8, 0, "");
    return head + std::string(length - head.size(), '\0');
  };
  const auto probes = [&](const std::string& bytes) { return probe_image(bytes_of(bytes), "flat").has_value(); };
  EXPECT_TRUE(probes(file(4096, 4096, 1000)));
  EXPECT_FALSE(probes(file(4097, 4096, 1000)));
  EXPECT_FALSE(probes(file(8192, 4096, 8192 * 64 - 1)));
  EXPECT_TRUE(probes(file(8192, 4096, 8192 * 64)));
  const auto refused = decode_image(bytes_of(file(16384, 16384, 261000)), "flat");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::input);
  EXPECT_NE(refused.error().message.find("out of proportion"), std::string::npos) << refused.error().text();
  EXPECT_FALSE(decode_image(bytes_of("#?RADIANCE\n\n-Y 16384 +X 16384\n"), "flat"));
}

TEST(Decode, HdrValuesOrderAndExposure) {
  const std::string pixels(
      "\x80\x40\x20\x81"
      "\x80\0\0\x80",
      8);
  const auto texel = [&](const std::string& head, size_t i) {
    const std::string file = head + pixels;
    const auto image = decode_image(bytes_of(file), "hdr");
    EXPECT_TRUE(image) << image.error().text();
    std::array<float, 4> value{};
    if (image) std::memcpy(value.data(), image->pixels.data() + i * 16, 16);
    return value;
  };
  EXPECT_EQ(texel("#?RADIANCE\n\n-Y 1 +X 2\n", 0), (std::array<float, 4>{1.0f, 0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(texel("#?RADIANCE\n\n-Y 1 -X 2\n", 1), (std::array<float, 4>{1.0f, 0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(texel("#?RGBE\n\n+Y 2 +X 1\n", 1), (std::array<float, 4>{1.0f, 0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(texel("#?RADIANCE\nEXPOSURE=2\n\n-Y 1 +X 2\n", 0), (std::array<float, 4>{0.5f, 0.25f, 0.125f, 1.0f}));
}

TEST(Environment, InfiniteTexelsStayBrightOthersThatMeanNothingBecomeZero) {
  FloatImage image{.width = 2, .height = 1};
  image.channels = {{"R", ChannelType::float32, {std::nanf(""), 1}},
                    {"G", ChannelType::float32, {2, -3}},
                    {"B", ChannelType::float32, {INFINITY, 4}}};
  const auto path = temporary("environment.exr");
  ASSERT_TRUE(write_exr(path, image));
  testing::internal::CaptureStderr();
  const auto environment = read_environment(path);
  const std::string log = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(environment);
  std::array<float, 8> texels;
  std::memcpy(texels.data(), environment->pixels.data(), sizeof texels);
  EXPECT_EQ(texels, (std::array<float, 8>{0, 2, 65504, 1, 1, 0, 4, 1}));
  EXPECT_NE(log.find("1 texels are not finite"), std::string::npos) << log;
  EXPECT_NE(log.find("1 texels are negative"), std::string::npos) << log;
  std::filesystem::remove(path);
}

TEST(Environment, RealAndMalformedFiles) {
  if (!std::filesystem::exists(assets)) GTEST_SKIP() << "the folder shared/assets is absent";
  for (const auto& entry : std::filesystem::directory_iterator(assets / "env")) {
    const auto image = read_environment(entry.path());
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_EQ(image->pixels.size(), size_t(image->width) * size_t(image->height) * 16);
    const auto texels = std::span(reinterpret_cast<const float*>(image->pixels.data()), image->pixels.size() / 4);
    EXPECT_GT(*std::max_element(texels.begin(), texels.end()), 0.0f) << entry.path();
  }
  for (const auto& entry : std::filesystem::directory_iterator(assets / "malformed/env")) {
    const auto image = read_environment(entry.path());
    ASSERT_FALSE(image) << entry.path();
    EXPECT_EQ(image.error().kind, ErrorKind::input);
  }
}

}  // namespace
}  // namespace candela::image_decode
