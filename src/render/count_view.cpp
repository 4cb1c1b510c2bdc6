#include "render/count_view.h"

#include <cmath>

#include "base/check.h"
#include "metrics/heatmap.h"

namespace candela {
namespace {

// Digits of 3 by 5 pixels, a row in three bits, from the top.
constexpr std::array<std::array<uint8_t, 5>, 10> digits = {{{7, 5, 5, 5, 7},
                                                            {2, 6, 2, 2, 7},
                                                            {7, 1, 7, 4, 7},
                                                            {7, 1, 7, 1, 7},
                                                            {5, 5, 7, 1, 1},
                                                            {7, 4, 7, 1, 7},
                                                            {7, 4, 7, 5, 7},
                                                            {7, 1, 1, 1, 1},
                                                            {7, 5, 7, 5, 7},
                                                            {7, 5, 7, 1, 7}}};
constexpr int digit_width = 3, digit_height = 5;

class Canvas {
 public:
  explicit Canvas(DisplayImage& image) : image_(image) {}
  void fill(int x, int y, int width, int height, std::array<uint8_t, 3> color) {
    for (int j = std::max(y, 0); j < std::min(y + height, image_.height); ++j)
      for (int i = std::max(x, 0); i < std::min(x + width, image_.width); ++i)
        for (size_t c = 0; c < 3; ++c)
          image_.pixels[(size_t(j) * size_t(image_.width) + size_t(i)) * 3 + c] = std::byte(color[c]);
  }
  void number(int x, int y, const std::string& text, int scale) {
    for (const char character : text) {
      const auto& rows = digits[size_t(character - '0')];
      for (int j = 0; j < digit_height; ++j)
        for (int i = 0; i < digit_width; ++i)
          if (rows[size_t(j)] >> (digit_width - 1 - i) & 1)
            fill(x + i * scale, y + j * scale, scale, scale, {255, 255, 255});
      x += (digit_width + 1) * scale;
    }
  }
  static int text_width(const std::string& text, int scale) {
    return int(text.size()) * (digit_width + 1) * scale - scale;
  }

 private:
  DisplayImage& image_;
};

}  // namespace

double count_scale(std::span<const float> counts) {
  float largest = 0;
  for (const float n : counts) largest = std::max(largest, n);
  double decade = 1;
  for (; decade < 1e9; decade *= 10)
    for (const double step : {1.0, 2.0, 5.0})
      if (double(largest) <= step * decade) return step * decade;
  return decade;
}

DisplayImage count_view(std::span<const float> counts, int width, int height) {
  CHECK(counts.size() == size_t(width) * size_t(height));
  const double end = count_scale(counts);
  Plane plane(counts.size());
  for (size_t i = 0; i < counts.size(); ++i) plane[i] = counts[i] > 0 ? float(double(counts[i]) / end) : 0;
  DisplayImage image = heatmap(plane, width, height);
  if (width < 96 || height < 48) return image;
  const int scale = width >= 640 && height >= 320 ? 2 : 1, bar = width / 4, thick = 4 * scale, gap = 3 * scale;
  const std::string first = "0", last = fmt::format("{:.0f}", end),
                    middle = end >= 2 ? fmt::format("{:.0f}", end / 2) : "";
  const int plate_height = 3 * gap + thick + digit_height * scale, x = 2 * gap, y = height - plate_height;
  Canvas canvas(image);
  canvas.fill(0, y, bar + 4 * gap, plate_height, {40, 40, 40});
  Plane ramp(size_t(bar) * size_t(thick));
  for (size_t i = 0; i < ramp.size(); ++i) ramp[i] = float(i % size_t(bar)) / float(bar - 1);
  const DisplayImage colors = heatmap(ramp, bar, thick);
  for (int j = 0; j < thick; ++j)
    std::copy_n(&colors.pixels[size_t(j) * size_t(bar) * 3], size_t(bar) * 3,
                &image.pixels[(size_t(y + gap + j) * size_t(width) + size_t(x)) * 3]);
  const int below = y + 2 * gap + thick;
  canvas.number(x, below, first, scale);
  canvas.number(x + (bar - Canvas::text_width(middle, scale)) / 2, below, middle, scale);
  canvas.number(x + bar - Canvas::text_width(last, scale), below, last, scale);
  return image;
}

}  // namespace candela
