#pragma once
#include "base/error.h"
#include "base/pixel_rect.h"

namespace candela {

struct Job;

// Where the pixels of a job's files lie: its size is the display window, which overscan reaches beyond, and of which a
// region may be all that is wanted.
struct PictureWindow {
  int display_width = 0, display_height = 0;
  int width_px = 0, height_px = 0;  // of the whole picture, with overscan
  PixelRect part;                   // what is wanted of it, from its own upper left corner
  PixelRect data;                   // the same from the display window's upper left corner: EXR's data window
  bool is_whole() const { return part == PixelRect{0, 0, width_px, height_px}; }
  bool is_plain() const { return data == PixelRect{0, 0, display_width, display_height}; }
};
PictureWindow picture_window(const Job& job);
// Errors (usage): an overscan that is none, a region that is empty or reaches beyond the picture.
Expected<void> check_window(const Job& job);
// For images of files (image/image.h): windows that differ are said.
template <class Image>
void set_windows(Image& image, const PictureWindow& window) {
  if (window.is_plain()) return;
  image.origin_x = window.data.x, image.origin_y = window.data.y;
  image.display_width = window.display_width, image.display_height = window.display_height;
}

}  // namespace candela
