#include "render/mip_chain.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/rng.h"

namespace candela {
namespace {

double srgb_decode(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

using Size = std::pair<int, int>;
const Size sizes[] = {{1, 1}, {2, 2}, {5, 3}, {1, 7}, {7, 1}, {8, 8}, {13, 6}, {64, 1}, {33, 65}};

template <class T>
DecodedImage make_image(int width, int height, const std::function<T(int, int)>& value) {
  DecodedImage image;
  image.width = width;
  image.height = height;
  image.format = sizeof(T) == 1   ? DecodedImage::Format::rgba8
                 : sizeof(T) == 2 ? DecodedImage::Format::rgba16
                                  : DecodedImage::Format::rgba32f;
  std::vector<T> texels;
  for (int i = 0; i < width * height; ++i)
    for (int c = 0; c < 4; ++c) texels.push_back(value(i, c));
  image.pixels.resize(texels.size() * sizeof(T));
  std::memcpy(image.pixels.data(), texels.data(), image.pixels.size());
  return image;
}

template <class T>
std::vector<T> texels(const std::vector<std::byte>& level) {
  std::vector<T> out(level.size() / sizeof(T));
  std::memcpy(out.data(), level.data(), level.size());
  return out;
}

int level_count(Size size) {
  int count = 1;
  for (int side = std::max(size.first, size.second); side > 1; side /= 2) ++count;
  return count;
}

template <class T>
void expect_constant(bool srgb) {
  for (const Size& size : sizes)
    for (const double part : {0.0, 1 / 255.0, 10 / 255.0, 0.2, 0.5, 254 / 255.0, 1.0}) {
      const double range = sizeof(T) == 1 ? 255 : sizeof(T) == 2 ? 65535 : 1;
      const T value = T(sizeof(T) == 4 ? part * 17 : std::round(part * range));
      const auto data = make_mip_chain(
          make_image<T>(size.first, size.second, [&](int, int c) { return c == 3 ? T(range) : value; }), srgb, true);
      for (const auto& level : data.levels) {
        const auto t = texels<T>(level);
        for (size_t i = 0; i < t.size(); ++i) {
          const double wanted = i % 4 == 3               ? range
                                : srgb && sizeof(T) == 2 ? std::round(srgb_decode(value / range) * range)
                                                         : double(value);
          EXPECT_NEAR(double(t[i]), wanted, sizeof(T) == 4 ? 1e-6 * wanted : 0) << size.first << "x" << size.second;
        }
      }
    }
}

}  // namespace

TEST(MipChain, HasAllLevelsDownToOneTexel) {
  for (const Size& size : sizes) {
    const auto image = make_image<uint8_t>(size.first, size.second, [](int i, int c) { return uint8_t(i * 7 + c); });
    const auto data = make_mip_chain(image, true, true);
    ASSERT_EQ(int(data.levels.size()), level_count(size)) << size.first << "x" << size.second;
    for (size_t l = 0; l < data.levels.size(); ++l)
      EXPECT_EQ(data.levels[l].size(),
                size_t(std::max(1, size.first >> l)) * size_t(std::max(1, size.second >> l)) * 4);
    EXPECT_EQ(data.levels[0], image.pixels);  // as stored, not decoded and encoded again
    EXPECT_EQ(make_mip_chain(image, true, false).levels.size(), 1u);
  }
}

TEST(MipChain, ConstantImagesStayConstant) {
  for (const bool srgb : {false, true}) {
    expect_constant<uint8_t>(srgb);
    expect_constant<uint16_t>(srgb);
  }
  expect_constant<float>(false);
}

TEST(MipChain, FormatsSayWhatTheTexelsMean) {
  const auto bytes = make_image<uint8_t>(2, 2, [](int, int) { return uint8_t(1); });
  const auto words = make_image<uint16_t>(2, 2, [](int, int) { return uint16_t(1); });
  const auto floats = make_image<float>(2, 2, [](int, int) { return 1.0f; });
  EXPECT_EQ(make_mip_chain(bytes, true, true).format, VK_FORMAT_R8G8B8A8_SRGB);
  EXPECT_EQ(make_mip_chain(bytes, false, true).format, VK_FORMAT_R8G8B8A8_UNORM);
  EXPECT_EQ(make_mip_chain(words, true, true).format, VK_FORMAT_R16G16B16A16_UNORM);
  EXPECT_EQ(make_mip_chain(floats, false, true).format, VK_FORMAT_R32G32B32A32_SFLOAT);
}

// Every level's mean over all its texels is that of the image, in linear light: to float rounding for float images, to
// the rounding of the code values (at most half of one, here of an 8-bit sRGB one) else.
TEST(MipChain, MeansAreKeptInLinearLight) {
  Rng rng(1);
  for (const Size& size : sizes) {
    std::vector<double> mean(4);
    const int count = size.first * size.second;
    const auto image = make_image<float>(size.first, size.second, [&](int, int c) {
      const float v = float(rng.uniform(0, 100));
      mean[size_t(c)] += v / count;
      return v;
    });
    for (const auto& level : make_mip_chain(image, false, true).levels) {
      const auto t = texels<float>(level);
      for (size_t c = 0; c < 4; ++c) {
        double sum = 0;
        for (size_t i = c; i < t.size(); i += 4) sum += t[i];
        EXPECT_NEAR(sum / double(t.size() / 4), mean[c], 1e-5 * mean[c]) << size.first << "x" << size.second;
      }
    }
  }
}

TEST(MipChain, SrgbTexelsAreAveragedInLinearLight) {
  Rng rng(2);
  for (const Size& size : sizes) {
    std::vector<double> mean(4);
    const int count = size.first * size.second;
    const auto image = make_image<uint8_t>(size.first, size.second, [&](int, int c) {
      const uint8_t v = uint8_t(rng.next() % 256);
      mean[size_t(c)] += (c == 3 ? v / 255.0 : srgb_decode(v / 255.0)) / count;
      return v;
    });
    const auto last = texels<uint8_t>(make_mip_chain(image, true, true).levels.back());
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_LE(srgb_decode((last[c] - 0.51) / 255), mean[c]);
      EXPECT_GE(srgb_decode((last[c] + 0.51) / 255), mean[c]);
    }
    EXPECT_NEAR(last[3], 255 * mean[3], 0.51);  // alpha is linear as stored
  }
  // Black and white in equal parts are the sRGB code of one half.
  const auto chess = make_image<uint8_t>(2, 2, [](int i, int) { return uint8_t(i == 0 || i == 3 ? 255 : 0); });
  EXPECT_EQ(texels<uint8_t>(make_mip_chain(chess, true, true).levels[1])[0], 188);
  EXPECT_EQ(texels<uint8_t>(make_mip_chain(chess, false, true).levels[1])[0], 128);
}

// An odd size: a texel of the next level covers one and a half or two and a half texels.
TEST(MipChain, OddSizesWeighTexelsByTheAreaTheyCover) {
  const auto image = make_image<float>(5, 1, [](int i, int) { return float(i == 2 ? 10 : i); });
  const auto half = texels<float>(make_mip_chain(image, false, true).levels[1]);
  ASSERT_EQ(half.size(), 8u);
  EXPECT_NEAR(half[0], (0 + 1 + 0.5 * 10) / 2.5, 1e-6);
  EXPECT_NEAR(half[4], (0.5 * 10 + 3 + 4) / 2.5, 1e-6);
}

}  // namespace candela
