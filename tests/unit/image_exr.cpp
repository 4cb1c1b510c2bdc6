#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>

#include "base/files.h"
#include "base/rng.h"
#include "image/exr.h"
#include "image/io.h"
#include "image/prepare.h"

namespace candela::image_exr {
namespace {

std::filesystem::path temporary(const std::string& name) { return std::filesystem::path(testing::TempDir()) / name; }

// Values that half holds exactly, smooth enough for the lossy compressions.
FloatImage every_type(int width = 37, int height = 41) {
  FloatImage image{.width = width, .height = height};
  image.channels = {{"R", ChannelType::half}, {"G", ChannelType::half},          {"B", ChannelType::half},
                    {"A", ChannelType::half}, {"depth.Z", ChannelType::float32}, {"id.object", ChannelType::uint32}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (size_t c = 0; c < 6; ++c) {
        Channel& channel = image.channels[c];
        if (channel.type == ChannelType::uint32)
          channel.u.push_back(0xffffff00u + uint32_t(x * y));
        else if (channel.type == ChannelType::half)
          channel.f.push_back(float(x + y * int(c + 1)) / 64.0f);
        else
          channel.f.push_back(1.0f + std::sqrt(float(x * 131 + y)));
      }
  return image;
}

class ExrCompressions : public testing::TestWithParam<const char*> {};

TEST_P(ExrCompressions, RoundTrip) {
  const std::string name = GetParam();
  const auto compression = exr_compression_from_name(name);
  ASSERT_TRUE(compression);
  const FloatImage image = every_type();
  const auto path = temporary("round_trip_" + name + ".exr");
  ASSERT_TRUE(write_exr(path, image, *compression));
  const auto back = read_image(path);
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->width, image.width);
  EXPECT_EQ(back->height, image.height);
  ASSERT_EQ(back->channels.size(), image.channels.size());
  const bool lossy_half = name.starts_with("b44") || name.starts_with("dwa");
  for (const Channel& channel : image.channels) {
    const Channel* read = back->find(channel.name);
    ASSERT_NE(read, nullptr) << channel.name;
    EXPECT_EQ(read->type, channel.type);
    EXPECT_EQ(read->u, channel.u);
    ASSERT_EQ(read->f.size(), channel.f.size());
    const bool exact = channel.type == ChannelType::half ? !lossy_half : name != "pxr24";
    // B44 steps by the range of a block of 4x4 pixels, so the error is not relative to the value alone.
    for (size_t i = 0; i < channel.f.size(); ++i)
      EXPECT_NEAR(read->f[i], channel.f[i], exact ? 0.0 : 0.05 * std::abs(channel.f[i]) + 0.05)
          << channel.name << " " << i;
  }
  std::filesystem::remove(path);
}
INSTANTIATE_TEST_SUITE_P(All, ExrCompressions,
                         testing::Values("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"));

TEST(Exr, UnknownCompressionIsAUsageError) {
  const auto compression = exr_compression_from_name("gzip");
  ASSERT_FALSE(compression);
  EXPECT_EQ(compression.error().kind, ErrorKind::usage);
}

TEST(Exr, SpecialValuesSurvive) {
  FloatImage image{.width = 3, .height = 1};
  const float inf = std::numeric_limits<float>::infinity();
  image.channels = {{"R", ChannelType::half, {std::nanf(""), -inf, 1e30f}},
                    {"Z", ChannelType::float32, {std::nanf(""), inf, -0.0f}}};
  const auto bytes = encode_exr(image, ExrCompression::zip, "image");
  ASSERT_TRUE(bytes);
  const auto back = decode_exr(std::as_bytes(std::span(*bytes)), "image");
  ASSERT_TRUE(back);
  const Channel &r = *back->find("R"), &z = *back->find("Z");
  EXPECT_TRUE(std::isnan(r.f[0]) && std::isnan(z.f[0]));
  EXPECT_EQ(r.f[1], -inf);
  EXPECT_EQ(r.f[2], 65504.0f);  // finite stays finite
  EXPECT_EQ(z.f[1], inf);
  EXPECT_TRUE(z.f[2] == 0 && std::signbit(z.f[2]));
}

TEST(Exr, BytesAreTheSameTwiceAndHoldNoDate) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::piz, ExrCompression::dwab}) {
    const FloatImage image = every_type(300, 700);
    const auto first = encode_exr(image, compression, ""), second = encode_exr(image, compression, "");
    ASSERT_TRUE(first && second);
    EXPECT_TRUE(*first == *second);
    EXPECT_EQ(first->find("capDate"), std::string::npos);
  }
}

// Blocks that are not whole, sides that are odd, and content that cannot be compressed; on one thread and on many.
TEST(Exr, OwnZipIsReadByOpenExr) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::zips})
    for (const auto& [width, height] : {std::pair(1, 1), {1, 17}, {33, 16}, {101, 47}}) {
      FloatImage image = every_type(width, height);
      Rng rng(3);
      Channel& noise = image.channels.emplace_back(Channel{"noise", ChannelType::uint32, {}, {}});
      for (int i = 0; i < width * height; ++i) noise.u.push_back(uint32_t(rng.next()));
      image.origin_x = -3, image.origin_y = 5, image.display_width = 200, image.display_height = 100;
      image.metadata.push_back({.name = std::string(40, 'n'), .text = "a name that needs the flag of long names"});
      const bool before = set_file_threads(false);
      const auto one = encode_exr(image, compression, "");
      set_file_threads(true);
      const auto many = encode_exr(image, compression, "");
      set_file_threads(before);
      ASSERT_TRUE(one && many);
      EXPECT_TRUE(*one == *many);
      const auto back = decode_exr(std::as_bytes(std::span(*one)), "image", true);
      ASSERT_TRUE(back) << back.error().text();
      EXPECT_EQ(back->origin_y, 5);
      ASSERT_EQ(back->channels.size(), image.channels.size());
      for (const Channel& channel : image.channels) {
        const Channel* read = back->find(channel.name);
        ASSERT_NE(read, nullptr);
        EXPECT_EQ(read->u, channel.u) << channel.name;
        EXPECT_EQ(read->f, channel.f) << channel.name;
      }
    }
}

TEST(Exr, MetadataAndWindows) {
  FloatImage image = every_type();
  using Kind = MetadataEntry::Kind;
  image.metadata = {{"device", Kind::text, "llvmpipe"},
                    {"exposure", Kind::number, "", 0.1},
                    {"framesPerSecond", Kind::number, "", 24},
                    {"frame", Kind::integer, "", 17},
                    {"worldToCamera", Kind::matrix44, "", 0, {}}};
  for (int i = 0; i < 16; ++i) image.metadata.back().matrix.push_back(float(i) * 0.5f);
  const auto path = temporary("metadata.exr");
  ASSERT_TRUE(write_exr(path, image));
  const auto back = read_image(path);
  ASSERT_TRUE(back);
  for (const MetadataEntry& entry : image.metadata) {
    const auto found =
        std::find_if(back->metadata.begin(), back->metadata.end(), [&](const auto& m) { return m.name == entry.name; });
    ASSERT_NE(found, back->metadata.end()) << entry.name;
    EXPECT_EQ(found->kind, entry.kind) << entry.name;
    EXPECT_EQ(found->text, entry.text);
    EXPECT_EQ(found->number, entry.number);
    EXPECT_EQ(found->matrix, entry.matrix);
  }
  EXPECT_EQ(back->display_width, 0);
  Imf::InputFile file(path.c_str());
  EXPECT_TRUE(file.header().dataWindow() == file.header().displayWindow());
  EXPECT_TRUE(Imf::chromaticities(file.header()) == Imf::Chromaticities());
  EXPECT_EQ(file.header().typedAttribute<Imf::M44fAttribute>("worldToCamera").value()[1][2], 3.0f);
  std::filesystem::remove(path);
}

TEST(Exr, ReservedMetadataIsRefusedAndLeavesNoFile) {
  FloatImage image = every_type();
  image.metadata = {{"compression", MetadataEntry::Kind::text, "zip"}};
  const auto path = temporary("reserved.exr");
  const auto written = write_exr(path, image);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::output);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Exr, EveryTruncationIsAnInputError) {
  for (const ExrCompression compression : {ExrCompression::none, ExrCompression::zip, ExrCompression::piz}) {
    const auto bytes = encode_exr(every_type(16, 16), compression, "");
    ASSERT_TRUE(bytes);
    for (size_t length = 0; length < bytes->size(); length += 1 + length / 50) {
      const auto image = decode_exr(std::as_bytes(std::span(bytes->data(), length)), "cut.exr");
      ASSERT_FALSE(image) << length << " of " << bytes->size();
      EXPECT_EQ(image.error().kind, ErrorKind::input);
      EXPECT_TRUE(image.error().text().starts_with("cut.exr: "));
    }
  }
}

// A head that promises far more pixels than the file can hold is refused before memory is taken for them.
TEST(Exr, SizeOutOfProportionIsRefused) {
  auto bytes = encode_exr(every_type(16, 16), ExrCompression::zip, "");
  ASSERT_TRUE(bytes);
  const std::string_view type("dataWindow\0box2i\0\x10\0\0\0", 21);
  const size_t at = bytes->find(type);
  ASSERT_NE(at, std::string::npos);
  for (const int32_t side : {60000, 70000, 0x7ffffff0, -5}) {
    const int32_t corner[2] = {side, side};
    std::memcpy(bytes->data() + at + type.size() + 8, corner, 8);
    const auto image = decode_exr(std::as_bytes(std::span(*bytes)), "huge.exr");
    ASSERT_FALSE(image) << side;
    EXPECT_EQ(image.error().kind, ErrorKind::input) << image.error().text();
  }
}

TEST(Exr, MutatedBytesNeverCrash) {
  uint32_t state = 12345;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const char* name : {"none", "rle", "zip", "piz", "pxr24", "b44", "dwaa"}) {
    const auto good = encode_exr(every_type(24, 40), *exr_compression_from_name(name), "");
    for (int round = 0; round < 150; ++round) {
      std::string bytes = *good;
      for (uint32_t n = 1 + random() % 8; n > 0; --n) bytes[random() % bytes.size()] = char(random());
      if (round % 4 == 0) bytes.resize(random() % bytes.size());
      const auto image = decode_exr(std::as_bytes(std::span(bytes)), "mutated");
      EXPECT_TRUE(image || !image.error().message.empty());
    }
  }
}

TEST(Exr, BytesAfterTheEndAreRefusedWhereTheWholeFileIsWanted) {
  for (const char* name : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    const auto encoded = encode_exr(every_type(), *exr_compression_from_name(name), "x.exr");
    ASSERT_TRUE(encoded) << encoded.error().text();
    const auto decoded = [](const std::string& file) {
      return decode_exr(std::as_bytes(std::span(file)), "x.exr", true);
    };
    EXPECT_TRUE(decoded(*encoded)) << name << ": " << decoded(*encoded).error().text();
    const auto longer = decoded(*encoded + "warning: ");
    ASSERT_FALSE(longer) << name;
    EXPECT_NE(longer.error().message.find("9 bytes follow the end"), std::string::npos) << longer.error().message;
  }
}

}  // namespace
}  // namespace candela::image_exr
