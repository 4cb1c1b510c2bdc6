#include "render/count_view.h"

#include <cmath>

#include "base/check.h"
#include "base/statistics.h"
#include "metrics/heatmap.h"

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
  return c == '+' ? Glyph{0, 2, 7, 2, 0} : Glyph{};
}
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
  void write(int x, int y, const std::string& text, int scale) {
    for (const char character : text) {
      const Glyph rows = glyph_of(character);
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

CountScale count_scale(std::span<const float> counts) {
  std::vector<double> some;
  for (const float n : counts)
    if (n > 0) some.push_back(n);
  if (some.empty()) return {};
  const double high = percentile(some, 0.99), largest = *std::max_element(some.begin(), some.end());
  for (double decade = 1; decade < 1e9; decade *= 10)
    for (const double step : {1.0, 2.0, 4.0, 6.0, 8.0})
      if (high <= step * decade) return {step * decade, largest > step * decade};
  return {1e9, largest > 1e9};
}

std::string count_title(const std::string& layer) {
  if (layer == "heatmap.lights") return "LIGHTS LISTED PER PIXEL";
  if (layer == "heatmap.waste") return "LIGHTS LISTED IN VAIN PER PIXEL";
  if (layer == "heatmap.missed") return "LIGHTS MISSED PER PIXEL";
  if (layer == "heatmap.traversal") return "TRAVERSAL COST PER RAY";
  if (layer == "heatmap.leaves") return "LEAF BOXES PER RAY";
  return "COUNT PER PIXEL";
}

DisplayImage count_view(std::span<const float> counts, int width, int height, const std::string& title) {
  CHECK(counts.size() == size_t(width) * size_t(height));
  const auto [end, cut] = count_scale(counts);
  Plane plane(counts.size());
  for (size_t i = 0; i < counts.size(); ++i)
    plane[i] = counts[i] > 0 ? float(std::min(double(counts[i]) / end, 1.0)) : 0;
  DisplayImage image = heatmap(plane, width, height);
  if (width < 160 || height < 60) return image;
  const int scale = width >= 1280 && height >= 640 ? 3 : width >= 640 && height >= 320 ? 2 : 1;
  const int bar = std::max(width / 4, Canvas::text_width(title, scale)), thick = 4 * scale, gap = 3 * scale;
  const std::string first = "0", last = fmt::format("{:.0f}{}", end, cut ? "+" : ""),
                    middle = end >= 2 ? fmt::format("{:.0f}", end / 2) : "";
  const int line = digit_height * scale;
  const int plate_height = 4 * gap + thick + 2 * line, x = 2 * gap, y = height - plate_height;
  Canvas canvas(image);
  canvas.fill(0, y, bar + 4 * gap, plate_height, {40, 40, 40});
  canvas.write(x, y + gap, title, scale);
  Plane ramp(size_t(bar) * size_t(thick));
  for (size_t i = 0; i < ramp.size(); ++i) ramp[i] = float(i % size_t(bar)) / float(bar - 1);
  const DisplayImage colors = heatmap(ramp, bar, thick);
  for (int j = 0; j < thick; ++j)
    std::copy_n(&colors.pixels[size_t(j) * size_t(bar) * 3], size_t(bar) * 3,
                &image.pixels[(size_t(y + 2 * gap + line + j) * size_t(width) + size_t(x)) * 3]);
  const int below = y + 3 * gap + line + thick;
  canvas.write(x, below, first, scale);
  canvas.write(x + (bar - Canvas::text_width(middle, scale)) / 2, below, middle, scale);
  canvas.write(x + bar - Canvas::text_width(last, scale), below, last, scale);
  return image;
}

}  // namespace candela
