#include "render/canvas.h"

#include <algorithm>

namespace candela {
namespace {

// Characters of 3 by 5 pixels, a row in three bits, from the top.
using Glyph = std::array<uint8_t, 5>;
constexpr std::array<Glyph, 10> digits = {{{7, 5, 5, 5, 7},
                                           {2, 6, 2, 2, 7},
                                           {7, 1, 7, 4, 7},
                                           {7, 1, 7, 1, 7},
                                           {5, 5, 7, 1, 1},
                                           {7, 4, 7, 1, 7},
                                           {7, 4, 7, 5, 7},
                                           {7, 1, 1, 1, 1},
                                           {7, 5, 7, 5, 7},
                                           {7, 5, 7, 1, 7}}};
constexpr std::array<Glyph, 26> letters = {
    {{2, 5, 7, 5, 5}, {6, 5, 6, 5, 6}, {3, 4, 4, 4, 3}, {6, 5, 5, 5, 6}, {7, 4, 6, 4, 7}, {7, 4, 6, 4, 4},
     {3, 4, 5, 5, 3}, {5, 5, 7, 5, 5}, {7, 2, 2, 2, 7}, {1, 1, 1, 5, 2}, {5, 5, 6, 5, 5}, {4, 4, 4, 4, 7},
     {5, 7, 7, 5, 5}, {6, 5, 5, 5, 5}, {2, 5, 5, 5, 2}, {6, 5, 6, 4, 4}, {2, 5, 5, 6, 3}, {6, 5, 6, 5, 5},
     {3, 4, 2, 1, 6}, {7, 2, 2, 2, 2}, {5, 5, 5, 5, 7}, {5, 5, 5, 5, 2}, {5, 5, 7, 7, 5}, {5, 5, 2, 5, 5},
     {5, 5, 2, 2, 2}, {7, 1, 2, 4, 7}}};
Glyph glyph_of(char c) {
  if (c >= '0' && c <= '9') return digits[size_t(c - '0')];
  if (c >= 'A' && c <= 'Z') return letters[size_t(c - 'A')];
  switch (c) {
    case '+':
      return {0, 2, 7, 2, 0};
    case '-':
      return {0, 0, 7, 0, 0};
    case '_':
      return {0, 0, 0, 0, 7};
    case '.':
      return {0, 0, 0, 0, 2};
    case '/':
      return {1, 1, 2, 4, 4};
    default:
      return {};
  }
}

}  // namespace

void Canvas::fill(int x, int y, int width, int height, std::array<uint8_t, 3> color) {
  for (int j = std::max(y, 0); j < std::min(y + height, image_.height); ++j)
    for (int i = std::max(x, 0); i < std::min(x + width, image_.width); ++i)
      for (size_t c = 0; c < 3; ++c)
        image_.pixels[(size_t(j) * size_t(image_.width) + size_t(i)) * 3 + c] = std::byte(color[c]);
}

void Canvas::write(int x, int y, const std::string& text, int scale) {
  for (const char character : text) {
    const Glyph rows = glyph_of(character);
    for (int j = 0; j < letter_height; ++j)
      for (int i = 0; i < letter_width; ++i)
        if (rows[size_t(j)] >> (letter_width - 1 - i) & 1)
          fill(x + i * scale, y + j * scale, scale, scale, {255, 255, 255});
    x += (letter_width + 1) * scale;
  }
}

}  // namespace candela
