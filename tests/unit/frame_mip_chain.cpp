#include "session/mip_chain.h"

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

// The chain made the plain way: each level as a whole in float, every texel by the areas that it covers.
std::vector<std::vector<float>> plain_chain(std::vector<float> in, Size size) {
  struct Cover {
    int first;
    std::vector<float> weights;
  };
  const auto cover = [](int from_size, int size, int at) {
    const double from = double(at) * from_size / size, to = double(at + 1) * from_size / size;
    Cover c{int(from), {}};
    for (int s = c.first; s < from_size && s < to - 1e-9; ++s)
      c.weights.push_back(float((std::min(to, s + 1.0) - std::max(from, double(s))) / (to - from)));
    return c;
  };
  std::vector<std::vector<float>> levels;
  while (size.first > 1 || size.second > 1) {
    const Size half = {std::max(1, size.first / 2), std::max(1, size.second / 2)};
    std::vector<float> out;
    for (int y = 0; y < half.second; ++y)
      for (int x = 0; x < half.first; ++x)
        for (int k = 0; k < 4; ++k) {
          const Cover rows = cover(size.second, half.second, y), columns = cover(size.first, half.first, x);
          float sum = 0;
          for (size_t j = 0; j < rows.weights.size(); ++j)
            for (size_t i = 0; i < columns.weights.size(); ++i) {
              const size_t at = (size_t(rows.first) + j) * size_t(size.first) + size_t(columns.first) + i;
              sum += rows.weights[j] * columns.weights[i] * in[at * 4 + size_t(k)];
            }
          out.push_back(sum);
        }
    levels.push_back(in = std::move(out));
    size = half;
  }
  return levels;
}

double srgb_encode(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

template <class T>
T to_code(float v, bool srgb) {
  const auto quantised = [&](float scale) { return int(std::clamp(v, 0.0f, 1.0f) * scale + 0.5f); };
  if constexpr (sizeof(T) == 4) return v;
  if (sizeof(T) == 2) return T(quantised(65535));
  return srgb ? T(std::lround(255 * srgb_encode(quantised(65535) / 65535.0))) : T(quantised(255));
}

template <class T>
void expect_plain_chain(Size size, bool srgb) {
  Rng rng(3);
  const float range = sizeof(T) == 1 ? 255 : 65535, scale = 1 / range;
  std::vector<float> linear;
  const auto image = make_image<T>(size.first, size.second, [&](int, int c) {
    const T v = sizeof(T) == 4 ? T(rng.uniform(-1, 100)) : T(rng.next() % (uint64_t(range) + 1));
    linear.push_back(sizeof(T) == 4   ? float(v)
                     : srgb && c != 3 ? float(srgb_decode(double(v) / double(range)))
                                      : float(v) * scale);
    return v;
  });
  const auto data = make_mip_chain(image, srgb, true);
  const auto wanted = plain_chain(linear, size);
  ASSERT_EQ(data.levels.size(), wanted.size() + 1);
  for (size_t l = 0; l < wanted.size(); ++l) {
    std::vector<T> codes;
    for (size_t i = 0; i < wanted[l].size(); ++i) codes.push_back(to_code<T>(wanted[l][i], srgb && i % 4 != 3));
    EXPECT_EQ(texels<T>(data.levels[l + 1]), codes) << size.first << "x" << size.second << " level " << l + 1;
  }
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

// Rows are converted on the fly and even sizes take a short cut; neither may change a bit.
TEST(MipChain, EqualsThePlainVersionToTheLastBit) {
  for (const Size& size :
       {Size{1, 7}, Size{7, 1}, Size{2, 9}, Size{9, 2}, Size{12, 20}, Size{13, 6}, Size{33, 65}, Size{64, 64}}) {
    for (const bool srgb : {false, true}) {
      expect_plain_chain<uint8_t>(size, srgb);
      expect_plain_chain<uint16_t>(size, srgb);
    }
    expect_plain_chain<float>(size, false);
  }
}

// 16-bit sRGB becomes linear, level 0 too.
TEST(MipChain, SixteenBitSrgbIsStoredLinear) {
  const auto image = make_image<uint16_t>(5, 3, [](int i, int c) { return uint16_t(i * 4000 + c * 977); });
  const auto level = texels<uint16_t>(make_mip_chain(image, true, true).levels[0]);
  for (size_t i = 0; i < 15 * 4; ++i) {
    const int v = int(i / 4) * 4000 + int(i % 4) * 977;
    EXPECT_EQ(level[i], i % 4 == 3 ? v : int(float(srgb_decode(v / 65535.0)) * 65535.0f + 0.5f)) << i;
  }
}

// Alpha of a normal map: none in level 0; of normals that lean by one slope to either side that slope, as their mean's
// length has it.
TEST(MipChain, NormalMapsSayHowFarTheyStray) {
  const double slope = 0.4, length = std::hypot(1.0, slope);
  const auto image = make_image<uint16_t>(4, 4, [&](int i, int c) {
    const double x = (i % 2 == 0 ? 1 : -1) * slope / length, n[] = {x, 0, 1 / length, 1};
    return c == 3 ? uint16_t(65535) : uint16_t(std::lround(65535 * (n[c] / 2 + 0.5)));
  });
  const auto plain = make_mip_chain(image, false, true), straying = make_mip_chain(image, false, true, true);
  ASSERT_EQ(plain.levels.size(), straying.levels.size());
  for (size_t l = 0; l < plain.levels.size(); ++l) {
    const auto a = texels<uint16_t>(plain.levels[l]), b = texels<uint16_t>(straying.levels[l]);
    for (size_t i = 0; i < a.size(); ++i)
      if (i % 4 != 3) {
        EXPECT_EQ(a[i], b[i]) << "level " << l;
      } else {
        EXPECT_NEAR(b[i] / 65535.0, l == 0 ? 0 : std::sqrt(length - 1), 1e-3) << "level " << l;
      }
  }
}

}  // namespace candela
