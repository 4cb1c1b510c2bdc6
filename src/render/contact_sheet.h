#pragma once
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace candela {

// A picture of a contact sheet: display-encoded planes of R, G and B in [0,1], as they stand before black, its alpha,
// and what stands below it.
struct SheetPicture {
  std::vector<std::vector<float>> planes;
  int width = 0, height = 0;
  std::string caption;
  std::vector<float> alpha = {};  // in [0,1]; empty: opaque
};
struct SheetLayout {
  int columns = 0;                          // 0: about as wide as high
  int tile_width = 320, tile_height = 180;  // pixels that a picture gets at most; it keeps its shape
};
// Pictures in rows on dark grey, in the order given. Larger ones are averaged down in linear light, pixel by covered
// pixel; smaller ones stay as they are. Where they are transparent they stand before a checker of greys. 8 bits, RGB.
DisplayImage contact_sheet(std::span<const SheetPicture> pictures, const SheetLayout& layout);

}  // namespace candela
