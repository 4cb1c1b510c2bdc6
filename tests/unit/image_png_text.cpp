#include "image/png_text.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

// A 1x1 grey PNG, made by hand from the specification.
std::vector<std::byte> smallest_png() {
  const unsigned char bytes[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
                                 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00,
                                 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78,
                                 0x9c, 0x63, 0x60, 0x00, 0x00, 0x00, 0x02, 0x00, 0x01, 0x48, 0xaf, 0xa4, 0x71, 0x00,
                                 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const auto span = std::as_bytes(std::span(bytes));
  return {span.begin(), span.end()};
}

TEST(PngText, ReadsBackWhatWasWritten) {
  const auto png = smallest_png();
  EXPECT_EQ(png_text(png, "key", "x.png").value(), "");
  const auto with = with_png_text(png, "key", "value 1");
  EXPECT_EQ(with.size(), png.size() + 12 + 4 + 7);
  EXPECT_EQ(png_text(with, "key", "x.png").value(), "value 1");
  EXPECT_EQ(png_text(with, "ke", "x.png").value(), "");
}

TEST(PngText, EveryTruncationAndEveryFlippedByteIsSeen) {
  const auto png = with_png_text(smallest_png(), "key", "value");
  for (size_t length = 0; length < png.size(); ++length)
    EXPECT_FALSE(png_text(std::span(png).first(length), "key", "x.png")) << length;
  for (size_t i = 0; i < png.size(); ++i) {
    auto damaged = png;
    damaged[i] ^= std::byte{1};
    EXPECT_FALSE(png_text(damaged, "key", "x.png")) << i;
  }
}

TEST(PngText, NothingMayFollowTheEnd) {
  auto png = smallest_png();
  ASSERT_TRUE(png_text(png, "key", "x.png"));
  png.push_back(std::byte{'w'});
  const auto text = png_text(png, "key", "x.png");
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("bytes follow its end"), std::string::npos) << text.error().message;
}

}  // namespace
}  // namespace candela
