#pragma once
#include <algorithm>

namespace candela {

// A part of a picture, in pixels from its upper left corner.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
  int end_x() const { return x + width; }
  int end_y() const { return y + height; }
  bool operator==(const PixelRect&) const = default;
};

inline PixelRect moved(const PixelRect& r, int x, int y) { return {r.x + x, r.y + y, r.width, r.height}; }
inline bool holds(const PixelRect& whole, const PixelRect& part) {
  return part.x >= whole.x && part.y >= whole.y && part.end_x() <= whole.end_x() && part.end_y() <= whole.end_y();
}
// Wider by `by` on each side and then to multiples of `step`, as far as the picture goes.
inline PixelRect grown(const PixelRect& r, int by, int step, int width, int height) {
  const int x = std::max(0, r.x - by) / step * step, y = std::max(0, r.y - by) / step * step;
  const auto up = [step](int v) { return (v + step - 1) / step * step; };
  const int end_x = std::min(width, up(r.end_x() + by)), end_y = std::min(height, up(r.end_y() + by));
  return {x, y, end_x - x, end_y - y};
}

}  // namespace candela
