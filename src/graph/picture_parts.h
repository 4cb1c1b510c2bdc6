#pragma once
#include <cstdint>

#include "base/pixel_rect.h"

namespace candela {

// What a frame works on of its picture, where only a region of it is wanted: images and coordinates stay those of the
// whole picture, so that each pixel is computed as in the whole, and passes draw and dispatch over a part.
enum class PicturePart : uint8_t {
  seen,    // where surfaces and their depths are found: what shading looks up around a pixel lies in it
  shaded,  // where they are shaded: the region, and what filters look up around it
};
struct PictureParts {
  PixelRect seen, shaded;
  int width_px = 0, height_px = 0;  // of the whole picture
  const PixelRect& of(PicturePart part) const { return part == PicturePart::seen ? seen : shaded; }
  bool operator==(const PictureParts&) const = default;
};

}  // namespace candela
