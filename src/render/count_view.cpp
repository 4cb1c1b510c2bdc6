#include "render/count_view.h"

#include <cmath>

#include "base/check.h"
#include "base/statistics.h"
#include "metrics/heatmap.h"
#include "render/canvas.h"

namespace candela {
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
  const int line = Canvas::letter_height * scale;
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
