#include "image/seal.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/files.h"
#include "image/io.h"
#include "image/png_text.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

void expect_sealed(const fs::path& file) {
  auto bytes = read_file(file);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(sealed_length(*bytes), bytes->size());
  std::vector<std::byte> same = *bytes;
  EXPECT_TRUE(seal_holds(same));
  for (const size_t at : {size_t(9), bytes->size() / 2, bytes->size() - 1}) {
    std::vector<std::byte> changed = *bytes;
    changed[at] ^= std::byte{1};
    EXPECT_FALSE(seal_holds(changed)) << at;
  }
  std::vector<std::byte> shorter(bytes->begin(), bytes->end() - 1);
  EXPECT_FALSE(seal_holds(shorter));
}

TEST(Seal, HoldsForTheBytesThatWereWrittenAlone) {
  const fs::path folder = fs::path(testing::TempDir());
  DisplayImage picture{.width = 16, .height = 9};
  picture.pixels.resize(16 * 9 * 3, std::byte{7});
  const fs::path png = folder / "candela-seal.png", exr = folder / "candela-seal.exr";
  ASSERT_TRUE(write_png(png, picture, {{"a", "b"}, {std::string(seal_name), open_seal()}}));
  expect_sealed(png);
  EXPECT_TRUE(png_text(*read_file(png), "a", ""));  // its checksums hold
  FloatImage linear{.width = 16, .height = 9};
  linear.channels.push_back({.name = "R", .f = std::vector<float>(16 * 9, 0.5f)});
  linear.metadata.push_back({.name = std::string(seal_name), .text = open_seal()});
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::piz}) {
    ASSERT_TRUE(write_exr(exr, linear, compression));
    expect_sealed(exr);
  }
  // What nobody sealed is no sealed file.
  ASSERT_TRUE(write_png(png, picture));
  auto unsealed = read_file(png);
  ASSERT_TRUE(unsealed);
  EXPECT_FALSE(seal_holds(*unsealed));
  fs::remove(png), fs::remove(exr);
}

}  // namespace
}  // namespace candela
