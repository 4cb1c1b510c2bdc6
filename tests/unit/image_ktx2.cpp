// KTX2 with Basis Universal texels. tests/images: *.ktx2 are Binomial's basisu 1.15 of pictures made for it, but for
// uastc_modes, whose blocks are random bits in every mode and partition; each PNG beside is what Basis Universal's own
// transcoder 1.16 makes of the file as RGBA of 8 bits.
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <cstring>
#include <set>

#include "image/io.h"
#include "image_files.h"

namespace candela {
namespace {

template <class T>
T get(const std::vector<std::byte>& file, size_t at) {
  T value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}
template <class T>
void put(std::vector<std::byte>& file, size_t at, T value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

// Where things lie in a KTX2 file.
constexpr size_t format_at = 12, height_at = 24, depth_at = 28, layers_at = 32, faces_at = 36, levels_at = 40,
                 packing_at = 44, texels_offset_at = 48, notes_offset_at = 56, global_offset_at = 64, level_at = 80;
size_t texels_format(const std::vector<std::byte>& file) { return get<uint32_t>(file, texels_offset_at); }

std::string error_of(const std::vector<std::byte>& file) {
  const auto image = decode_image(file, "images/3");
  if (image) return "";
  EXPECT_EQ(image.error().kind, ErrorKind::input);
  EXPECT_TRUE(image.error().text().starts_with("images/3: ")) << image.error().text();
  return image.error().text();
}

class Ktx2Truth : public testing::TestWithParam<const char*> {};
TEST_P(Ktx2Truth, IsWhatBasisUniversalMakes) {
  const auto file = file_of(std::string(GetParam()) + ".ktx2"), truth = file_of(std::string(GetParam()) + ".png");
  const auto image = decode_image(file, "file"), wanted = decode_image(truth, "truth");
  ASSERT_TRUE(image) << image.error().text();
  ASSERT_TRUE(wanted) << wanted.error().text();
  ASSERT_EQ(image->width, wanted->width);
  ASSERT_EQ(image->height, wanted->height);
  EXPECT_EQ(image->source_channels, wanted->source_channels);
  EXPECT_TRUE(image->pixels == wanted->pixels);
  const auto info = probe_image(file, "file");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->width, image->width);
  EXPECT_EQ(info->height, image->height);
  EXPECT_EQ(info->channels, image->source_channels);
}
INSTANTIATE_TEST_SUITE_P(Files, Ktx2Truth, testing::Values("uastc_modes", "etc1s_alpha", "etc1s_58x42"));

// The truth above is no truth of modes that the file lacks.
TEST(Ktx2, TheFileOfModesHasEveryMode) {
  constexpr std::pair<int, int> codes[] = {{0x1, 4}, {0x35, 6}, {0x1D, 5}, {0x3, 5},  {0x13, 5}, {0xB, 5}, {0x1B, 5},
                                           {0x7, 5}, {0x17, 5}, {0xF, 5},  {0x2, 3},  {0x0, 2},  {0x6, 3}, {0x1F, 5},
                                           {0xD, 5}, {0x5, 7},  {0x15, 6}, {0x25, 6}, {0x9, 4}};
  const auto file = file_of("uastc_modes.ktx2");
  std::set<size_t> modes;
  for (size_t at = get<uint64_t>(file, level_at); at < file.size(); at += 16)
    for (size_t m = 0; m < std::size(codes); ++m)
      if ((int(file[at]) & ((1 << codes[m].second) - 1)) == codes[m].first) modes.insert(m);
  EXPECT_EQ(modes.size(), 19u);
}

// The file's level 0 packed anew.
std::vector<std::byte> repacked(uint32_t packing, const std::vector<std::byte>& packed) {
  std::vector<std::byte> file = file_of("uastc_modes.ktx2");
  file.resize(get<uint64_t>(file, level_at));
  file.insert(file.end(), packed.begin(), packed.end());
  put(file, packing_at, packing);
  put<uint64_t>(file, level_at + 8, packed.size());
  return file;
}

TEST(Ktx2, ZstandardAndZlibUnpack) {
  const auto plain = file_of("uastc_modes.ktx2");
  const auto wanted = decode_image(plain, "plain");
  ASSERT_TRUE(wanted);
  const size_t at = get<uint64_t>(plain, level_at), size = get<uint64_t>(plain, level_at + 8);
  std::vector<std::byte> zstandard(ZSTD_compressBound(size));
  zstandard.resize(ZSTD_compress(zstandard.data(), zstandard.size(), plain.data() + at, size, 3));
  uLongf length = compressBound(size);
  std::vector<std::byte> zlib(length);
  ASSERT_EQ(
      compress(reinterpret_cast<Bytef*>(zlib.data()), &length, reinterpret_cast<const Bytef*>(plain.data() + at), size),
      Z_OK);
  zlib.resize(length);
  for (const auto& [packing, packed] : {std::pair(2u, zstandard), std::pair(3u, zlib)}) {
    const auto image = decode_image(repacked(packing, packed), "packed");
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_TRUE(image->pixels == wanted->pixels) << packing;
    auto broken = packed;
    broken.resize(packed.size() / 2);
    EXPECT_NE(error_of(repacked(packing, broken)).find("does not unpack to 4096 bytes"), std::string::npos);
  }
  // A stream of more than the picture needs, and one of less.
  for (const size_t other : {size + 16, size - 16}) {
    const std::vector<std::byte> blocks(other);
    std::vector<std::byte> packed(ZSTD_compressBound(other));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), blocks.data(), other, 3));
    EXPECT_NE(error_of(repacked(2, packed)).find("does not unpack to 4096 bytes"), std::string::npos) << other;
  }
}

// A picture of 3x2 plain texels, packed and not: channels that are not there are 0, alpha 1.
TEST(Ktx2, PlainTexelsOfEightBitsAreRead) {
  auto head = file_of("uastc_modes.ktx2");
  const size_t level = get<uint64_t>(head, level_at);
  head.resize(level);
  put(head, height_at - 4, 3u), put(head, height_at, 2u);
  for (const auto& [format, channels, transfer] : {std::tuple(9u, 1, Transfer::linear),
                                                   {22u, 2, Transfer::srgb},
                                                   {29u, 3, Transfer::srgb},
                                                   {37u, 4, Transfer::linear}})
    for (const uint32_t packing : {0u, 2u}) {
      std::vector<std::byte> texels;
      for (int i = 0; i < 6 * channels; ++i) texels.push_back(std::byte(7 * i + 3));
      std::vector<std::byte> stored = texels;
      if (packing == 2) {
        stored.resize(ZSTD_compressBound(texels.size()));
        stored.resize(ZSTD_compress(stored.data(), stored.size(), texels.data(), texels.size(), 3));
      }
      auto file = head;
      file.insert(file.end(), stored.begin(), stored.end());
      put(file, format_at, format), put(file, packing_at, packing);
      put(file, level_at + 8, uint64_t(stored.size()));
      const auto image = decode_image(file, "plain");
      ASSERT_TRUE(image) << image.error().text();
      EXPECT_EQ(probe_image(file, "plain")->transfer, transfer);
      for (size_t i = 0; i < 6; ++i)
        for (size_t c = 0; c < 4; ++c)
          EXPECT_EQ(image->pixels[4 * i + c], c < size_t(channels) ? texels[i * size_t(channels) + c]
                                              : c == 3             ? std::byte(255)
                                                                   : std::byte(0));
      file.resize(level + stored.size() - 1);
      put(file, level_at + 8, uint64_t(stored.size() - 1));
      EXPECT_NE(error_of(file), "");
    }
}

TEST(Ktx2, ChannelsAreWhatTheFileSays) {
  auto file = file_of("uastc_modes.ktx2");
  const auto all = decode_image(file, "all");
  ASSERT_TRUE(all);
  const size_t channel_at = texels_format(file) + 4 + 24 + 3;
  for (const auto& [channel, green] : {std::pair(0, 1), std::pair(4, 1), std::pair(5, 3), std::pair(6, 1)}) {
    put(file, channel_at, uint8_t(channel));
    const auto image = decode_image(file, "some");
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_EQ(image->source_channels, 3);
    for (size_t i = 0; i < image->pixels.size(); i += 4) {
      ASSERT_EQ(image->pixels[i], all->pixels[i]);
      ASSERT_EQ(image->pixels[i + 1], all->pixels[i + size_t(green)]);
      ASSERT_EQ(image->pixels[i + 3], std::byte(255));
    }
  }
}

TEST(Ktx2, SaysWhatItsNumbersAre) {
  auto file = file_of("uastc_modes.ktx2");
  for (const auto& [code, transfer] :
       {std::pair(1, Transfer::linear), std::pair(2, Transfer::srgb), std::pair(0, Transfer::unsaid)}) {
    put(file, texels_format(file) + 4 + 10, uint8_t(code));
    EXPECT_EQ(probe_image(file, "file")->transfer, transfer);
  }
}

TEST(Ktx2, WhatIsNotReadIsRefusedByName) {
  const auto good = file_of("uastc_modes.ktx2"), small = file_of("etc1s_alpha.ktx2");
  const auto refusal = [](std::vector<std::byte> file, size_t at, auto value, const std::string& names) {
    put(file, at, value);
    const std::string error = error_of(file);
    EXPECT_NE(error.find(names), std::string::npos) << error << " for " << names;
  };
  const size_t model_at = texels_format(good) + 4 + 8;
  refusal(good, format_at, 97u, "Vulkan's format 97; Basis Universal's");
  refusal(good, format_at, 43u, "truncated");
  refusal(good, height_at, 0u, "no flat image");
  refusal(good, height_at, 0x7fffffffu, "out of range");
  refusal(good, depth_at, 2u, "2 depth");
  refusal(good, layers_at, 2u, "2 layers");
  refusal(good, faces_at, 6u, "6 faces");
  refusal(good, levels_at, 40u, "40 levels");
  refusal(good, packing_at, 4u, "scheme 4; none, BasisLZ, Zstandard and zlib");
  refusal(good, packing_at, 1u, "UASTC texels packed by scheme 1");
  refusal(small, packing_at, 2u, "ETC1S texels packed by scheme 2");
  refusal(good, model_at, uint8_t(167), "color model 167; ETC1S (163) and UASTC (166)");
  refusal(good, model_at + 3, uint8_t(1), "premultiplied");
  refusal(good, model_at + 16 + 3, uint8_t(9), "its channels");
  refusal(good, get<uint64_t>(good, level_at) + 16 * 5, uint8_t(0x45), "block 5 is of a mode or partition");
  refusal(good, get<uint64_t>(good, level_at), uint64_t(0x1d | 30 << 20), "block 0 is of a mode or partition");
  refusal(small, get<uint64_t>(small, global_offset_at) + 20, 2u, "a difference to another");
  refusal(small, get<uint64_t>(small, global_offset_at), uint16_t(0), "a codebook is empty");
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>("KTXorientation", "lu"), {"KTXswizzle", "bgra"}}) {
    const std::string note = name + '\0' + text + '\0';
    auto file = good;
    put(file, notes_offset_at, uint32_t(good.size()));
    put(file, notes_offset_at + 4, uint32_t(4 + note.size()));
    file.resize(good.size() + 4 + note.size());
    put(file, good.size(), uint32_t(note.size()));
    std::memcpy(file.data() + good.size() + 4, note.data(), note.size());
    EXPECT_NE(error_of(file).find(fmt::format("its {} is '{}'", name, text)), std::string::npos) << error_of(file);
  }
}

// Offsets and lengths of every part at and around the limits of their words.
TEST(Ktx2, NoOffsetOrLengthLeadsOutOfTheFile) {
  for (const auto& good : {file_of("uastc_modes.ktx2"), file_of("etc1s_alpha.ktx2")}) {
    for (const size_t at : {48, 52, 56, 60})
      for (const uint32_t value : {uint32_t(good.size()), uint32_t(good.size() + 1), 0x7fffffffu, 0xffffffffu}) {
        auto file = good;
        put(file, at, value);
        decode_image(file, "cut");
        if (value > good.size()) EXPECT_NE(error_of(file), "") << at << " " << value;
      }
    for (const size_t at : {64, 72, 80, 88})
      for (const uint64_t value : {uint64_t(good.size()) + 1, ~uint64_t(0), ~uint64_t(0) - 15, uint64_t(1) << 63}) {
        auto file = good;
        put(file, at, value);
        EXPECT_NE(error_of(file), "") << at << " " << value;
      }
  }
  const auto good = file_of("etc1s_alpha.ktx2");
  const size_t global = get<uint64_t>(good, global_offset_at);
  for (const size_t at : {4, 8, 12, 24, 28, 32, 36})
    for (const uint32_t value : {uint32_t(good.size()), 0x7fffffffu, 0xffffffffu}) {
      auto file = good;
      put(file, global + at, value);
      EXPECT_NE(error_of(file), "") << at << " " << value;
    }
}

}  // namespace
}  // namespace candela
