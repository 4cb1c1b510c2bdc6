#pragma once
#include <string>

#include "image/image.h"

namespace candela {

// A colour map and what its ends mean, in the lower left corner of a picture of 8 bits, RGB, where that is large
// enough (160x60): title, bar, and the values at its left end, middle and right end. Capitals alone are drawn.
struct ScaleBar {
  std::string title, first, middle, last;
  bool falling = false;  // the map's end stands on the left
};
void draw_scale_bar(DisplayImage& image, const ScaleBar& bar);

}  // namespace candela
