#include "render/picture_distance.h"

#include <cmath>
#include <cstring>

#include "base/check.h"
#include "metrics/flip.h"
#include "metrics/planes.h"

namespace candela {
namespace {

// Red, green and blue in [0,1] times alpha.
std::vector<Plane> planes_of(const DisplayImage& image) {
  const size_t count = size_t(image.width) * size_t(image.height), channels = size_t(image.channels);
  const bool wide = image.bits == 16;
  const auto value = [&](size_t i) {
    uint16_t word = 0;
    if (!wide) return float(std::to_integer<uint8_t>(image.pixels[i])) / 255.0f;
    std::memcpy(&word, image.pixels.data() + 2 * i, 2);
    return float(word) / 65535.0f;
  };
  std::vector<Plane> planes(3, Plane(count));
  for (size_t p = 0; p < count; ++p) {
    const float alpha = channels == 4 ? value(channels * p + 3) : 1;
    for (size_t c = 0; c < 3; ++c) planes[c][p] = alpha * value(channels * p + c);
  }
  return planes;
}

}  // namespace

PictureDistance picture_distance(const DisplayImage& before, const DisplayImage& now) {
  CHECK(before.width == now.width && before.height == now.height);
  const std::vector<Plane> a = planes_of(before), b = planes_of(now);
  PictureDistance distance;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c)
    sum += sum_rows(now.height, [&](int y) {
      double row = 0;
      for (size_t p = size_t(y) * size_t(now.width), end = p + size_t(now.width); p < end; ++p) {
        const double d = double(b[c][p]) - double(a[c][p]);
        row += d * d;
      }
      return row;
    });
  distance.rmse = std::sqrt(sum / (3.0 * double(now.width) * double(now.height)));
  if (distance.rmse > 0) distance.flip = flip_mean(flip_map(a, b, now.width, now.height), now.width, now.height);
  return distance;
}

}  // namespace candela
