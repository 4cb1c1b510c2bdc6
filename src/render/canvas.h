#pragma once
#include <array>
#include <string>

#include "image/image.h"

namespace candela {

// Rectangles and small text in an image of 8 bits, RGB. Letters are capitals, 3 by 5 pixels times `scale`; characters
// without a form are blanks.
class Canvas {
 public:
  static constexpr int letter_width = 3, letter_height = 5;
  explicit Canvas(DisplayImage& image) : image_(image) {}
  void fill(int x, int y, int width, int height, std::array<uint8_t, 3> color);
  void write(int x, int y, const std::string& text, int scale);
  static int text_width(const std::string& text, int scale) {
    return int(text.size()) * (letter_width + 1) * scale - scale;
  }

 private:
  DisplayImage& image_;
};

}  // namespace candela
