#include "metrics/difference.h"

#include <cstring>

#include "base/check.h"

namespace candela {

DisplayDifference display_difference(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width,
                                     int height) {
  CHECK(reference.size() == 3 && test.size() == 3 && reference[0].size() == size_t(width) * size_t(height) &&
        test[0].size() == reference[0].size());
  DisplayDifference difference{.map = Plane(reference[0].size())};
  for (size_t i = 0; i < difference.map.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float away = std::abs(std::clamp(test[c][i], 0.0f, 1.0f) - std::clamp(reference[c][i], 0.0f, 1.0f));
      difference.map[i] = std::max(difference.map[i], away);
    }
    if (difference.map[i] > difference.largest) {
      difference.largest = difference.map[i];
      difference.x = int(i % size_t(width)), difference.y = int(i / size_t(width));
    }
  }
  return difference;
}

Around square_around(int x, int y, int side_px, int width, int height) {
  Around part{.width = std::min(side_px, width), .height = std::min(side_px, height)};
  part.x = std::clamp(x - part.width / 2, 0, width - part.width);
  part.y = std::clamp(y - part.height / 2, 0, height - part.height);
  return part;
}

DisplayImage cut_out(const DisplayImage& image, const Around& part) {
  CHECK(part.x >= 0 && part.y >= 0 && part.x + part.width <= image.width && part.y + part.height <= image.height);
  DisplayImage cut{part.width, part.height, image.channels, image.bits, {}};
  const size_t pixel = size_t(image.channels) * size_t(image.bits / 8);
  cut.pixels.resize(size_t(part.width) * size_t(part.height) * pixel);
  for (int y = 0; y < part.height; ++y)
    std::memcpy(&cut.pixels[size_t(y) * size_t(part.width) * pixel],
                &image.pixels[size_t(part.y + y) * row_bytes(image) + size_t(part.x) * pixel],
                size_t(part.width) * pixel);
  return cut;
}

}  // namespace candela
