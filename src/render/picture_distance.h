#pragma once
#include "image/image.h"

namespace candela {

// How far two pictures are apart as they are displayed, before black where they are transparent.
struct PictureDistance {
  double rmse = 0;  // of display-encoded values, 0 to 1
  double flip = 0;  // mean LDR-FLIP (metrics/flip.h)
};
// Of pictures of one size.
PictureDistance picture_distance(const DisplayImage& before, const DisplayImage& now);

}  // namespace candela
