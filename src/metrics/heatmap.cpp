#include "metrics/heatmap.h"

#include "base/check.h"

namespace candela {
namespace {

// The colour map "magma" of Nathaniel J. Smith and Stefan van der Walt (matplotlib, CC0) at ten even steps, sRGB codes;
// the lightness grows evenly, so that it can be read in grey too. Between the steps the codes are interpolated.
constexpr std::array<std::array<uint8_t, 3>, 10> magma = {{{0x00, 0x00, 0x04},
                                                           {0x18, 0x0f, 0x3e},
                                                           {0x45, 0x10, 0x77},
                                                           {0x72, 0x1f, 0x81},
                                                           {0x9f, 0x2f, 0x7f},
                                                           {0xcd, 0x40, 0x71},
                                                           {0xf1, 0x60, 0x5d},
                                                           {0xfd, 0x95, 0x67},
                                                           {0xfe, 0xc9, 0x8d},
                                                           {0xfc, 0xfd, 0xbf}}};

void put_colour(float value, std::byte* target) {
  const float position = (value > 0 ? std::min(value, 1.0f) : 0.0f) * float(magma.size() - 1);
  const size_t step = std::min(size_t(position), magma.size() - 2);
  const float part = position - float(step);
  for (size_t c = 0; c < 3; ++c)
    target[c] = std::byte(uint8_t(std::lround(float(magma[step][c]) * (1 - part) + float(magma[step + 1][c]) * part)));
}

}  // namespace

DisplayImage heatmap(const Plane& map, int width, int height) {
  CHECK(map.size() == size_t(width) * size_t(height));
  DisplayImage image{.width = width, .height = height};
  image.pixels.resize(map.size() * 3);
  for (size_t i = 0; i < map.size(); ++i) put_colour(map[i], &image.pixels[i * 3]);
  return image;
}

DisplayImage as_display(const std::vector<Plane>& planes, int width, int height) {
  DisplayImage image{.width = width, .height = height, .channels = 3, .bits = 8};
  image.pixels.resize(size_t(width) * size_t(height) * 3);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = std::byte(int(std::clamp(planes[i % 3][i / 3], 0.0f, 1.0f) * 255.0f + 0.5f));
  return image;
}

DisplayImage side_by_side(const std::vector<Plane>& reference, const std::vector<Plane>& test, const Plane& map,
                          int width, int height) {
  CHECK(reference.size() == 3 && test.size() == 3 && map.size() == size_t(width) * size_t(height));
  DisplayImage image{.width = width * 3, .height = height};
  image.pixels.resize(map.size() * 9);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t from = size_t(y) * size_t(width) + size_t(x);
      std::byte* row = &image.pixels[size_t(y) * size_t(width) * 9];
      for (size_t c = 0; c < 3; ++c) {
        const auto code = [](float v) { return std::byte(uint8_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f))); };
        row[size_t(x) * 3 + c] = code(reference[c][from]);
        row[size_t(x + width) * 3 + c] = code(test[c][from]);
      }
      put_colour(map[from], row + size_t(x + 2 * width) * 3);
    }
  return image;
}

}  // namespace candela
