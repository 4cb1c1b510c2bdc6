#pragma once
#include "image/image.h"
#include "metrics/planes.h"

namespace candela {

// How far two pictures are apart as they are displayed, pixel by pixel: the channel that differs most, 0 to 1.
struct DisplayDifference {
  Plane map;
  float largest = 0;
  int x = 0, y = 0;  // of the largest, in pixels from the upper left corner; the first in reading order
};
// Planes of R, G and B, as display_planes() gives them.
DisplayDifference display_difference(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width,
                                     int height);

// The square of at most `side_px` pixels about a place, moved into the picture where it would reach beyond.
struct Around {
  int x = 0, y = 0, width = 0, height = 0;  // of the square, in pixels of the picture
};
Around square_around(int x, int y, int side_px, int width, int height);
DisplayImage cut_out(const DisplayImage& image, const Around& part);

}  // namespace candela
