#pragma once
#include <string_view>

#include "base/error.h"
#include "image/image.h"
#include "metrics/planes.h"

namespace candela {

// Pixels of the data window, from its upper left corner.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
  std::string text() const { return fmt::format("{},{},{},{}", x, y, width, height); }
};
Expected<Region> parse_region(std::string_view text);                      // "X,Y,W,H"; errors: usage
Expected<void> check_region(const Region& region, int width, int height);  // that it lies within; errors: usage

FloatImage crop(const FloatImage& image, const Region& region);
Plane crop(const Plane& plane, int width, const Region& region);

}  // namespace candela
