// WebP through libwebp. tests/images: a picture of 40x24 by libwebp's encoder, with and without loss.
#include <gtest/gtest.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <cstring>

#include "image/io.h"
#include "image_files.h"

namespace candela {
namespace {

constexpr int width = 40, height = 24;

std::vector<uint8_t> picture(int channels) {
  std::vector<uint8_t> codes;
  for (int i = 0; i < width * height * channels; ++i) codes.push_back(uint8_t(i * 37 + i / 97 * 11));
  return codes;
}
std::vector<std::byte> taken(uint8_t* bytes, size_t size) {
  const auto* first = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> out(first, first + size);
  WebPFree(bytes);
  return out;
}

TEST(Webp, LosslessPicturesAreExact) {
  uint8_t* encoded = nullptr;
  const auto codes = picture(4);
  size_t size = WebPEncodeLosslessRGBA(codes.data(), width, height, width * 4, &encoded);
  const auto file = taken(encoded, size);
  const auto image = decode_image(file, "picture");
  ASSERT_TRUE(image) << image.error().text();
  EXPECT_EQ(image->width, width);
  EXPECT_EQ(image->height, height);
  EXPECT_EQ(image->source_channels, 4);
  EXPECT_EQ(image->format, DecodedImage::Format::rgba8);
  // Encoders drop colours where nothing is seen.
  ASSERT_EQ(image->pixels.size(), codes.size());
  for (size_t i = 0; i < codes.size(); i += 4) {
    ASSERT_EQ(uint8_t(image->pixels[i + 3]), codes[i + 3]);
    if (codes[i + 3] > 0)
      for (size_t c = 0; c < 3; ++c) ASSERT_EQ(uint8_t(image->pixels[i + c]), codes[i + c]);
  }

  const auto opaque = picture(3);
  size = WebPEncodeLosslessRGB(opaque.data(), width, height, width * 3, &encoded);
  const auto plain = decode_image(taken(encoded, size), "picture");
  ASSERT_TRUE(plain) << plain.error().text();
  EXPECT_EQ(plain->source_channels, 3);
  for (size_t i = 0; i < opaque.size(); ++i) ASSERT_EQ(uint8_t(plain->pixels[i / 3 * 4 + i % 3]), opaque[i]);
}

TEST(Webp, PicturesWithLossAreNear) {
  const auto exact = decode_image(file_of("lossless.webp"), "exact"),
             near = decode_image(file_of("lossy_alpha.webp"), "near");
  ASSERT_TRUE(exact) << exact.error().text();
  ASSERT_TRUE(near) << near.error().text();
  ASSERT_EQ(near->pixels.size(), exact->pixels.size());
  double sum = 0;
  for (size_t i = 0; i < exact->pixels.size(); ++i) {
    const double d = double(uint8_t(near->pixels[i])) - double(uint8_t(exact->pixels[i]));
    sum += d * d;
  }
  // The encoder loses 6.1 codes here, most of it colour at half the resolution; channels or rows in another order tens.
  EXPECT_LT(std::sqrt(sum / double(exact->pixels.size())), 8);
  EXPECT_GT(sum, 0);
  int simple_width = 0, simple_height = 0;
  const auto file = file_of("lossy_alpha.webp");
  const std::unique_ptr<uint8_t, void (*)(void*)> simple(
      WebPDecodeRGBA(reinterpret_cast<const uint8_t*>(file.data()), file.size(), &simple_width, &simple_height),
      WebPFree);
  ASSERT_TRUE(simple);
  EXPECT_EQ(std::memcmp(simple.get(), near->pixels.data(), near->pixels.size()), 0);
}

TEST(Webp, FilmsAndDamageAreNamed) {
  // A head that says "animation", a chunk of the film's own and one empty frame.
  std::string film("RIFF\x4a\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0\x27\0\0\x17\0\0", 30);
  film += std::string("ANIM\6\0\0\0\0\0\0\0\0\0", 14) + std::string("ANMF\x10\0\0\0", 8) + std::string(30, '\0');
  const auto refused = [](std::span<const std::byte> file, const std::string& names) {
    for (const auto& error : {probe_image(file, "images/1").error(), decode_image(file, "images/1").error()}) {
      EXPECT_EQ(error.kind, ErrorKind::input);
      EXPECT_TRUE(error.text().starts_with("images/1: ")) << error.text();
      EXPECT_NE(error.text().find(names), std::string::npos) << error.text();
    }
  };
  refused(std::as_bytes(std::span(film)), "is a film");
  const auto good = file_of("lossless.webp");
  refused(std::span(good).first(40), "truncated");
  auto broken = file_of("lossy_alpha.webp");
  for (size_t i = 60; i < broken.size(); ++i) broken[i] = std::byte(0xff);
  EXPECT_FALSE(decode_image(broken, "broken"));
  ASSERT_TRUE(decode_image(good, "good", width));
  EXPECT_FALSE(decode_image(good, "good", width - 1)) << "more than the largest side";
}

// A picture of one colour may have any size and a hundred bytes; here only the head says so.
TEST(Webp, ManyPixelsFromFewBytesAreRefused) {
  auto file = file_of("lossless.webp");
  const uint32_t sides = 0x3fff | 0x3fff << 14 | 1u << 28;
  std::memcpy(file.data() + 21, &sides, 4);
  const auto image = decode_image(file, "flat");
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().text().find("16384x16384 pixels from"), std::string::npos) << image.error().text();
}

}  // namespace
}  // namespace candela
