#include "render/count_view.h"

#include <cmath>

#include "base/check.h"
#include "base/statistics.h"
#include "metrics/heatmap.h"
#include "render/scale_bar.h"

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
  if (layer == "heatmap_lights") return "LIGHTS LISTED PER PIXEL";
  if (layer == "heatmap_waste") return "LIGHTS LISTED IN VAIN PER PIXEL";
  if (layer == "heatmap_missed") return "LIGHTS MISSED PER PIXEL";
  if (layer == "debug_light_volumes") return "LIGHT VOLUMES PER PIXEL";
  if (layer == "heatmap_traversal") return "TRAVERSAL COST PER RAY";
  if (layer == "heatmap_leaves") return "LEAF BOXES PER RAY";
  return "COUNT PER PIXEL";
}

DisplayImage count_view(std::span<const float> counts, int width, int height, const std::string& title) {
  CHECK(counts.size() == size_t(width) * size_t(height));
  const auto [end, cut] = count_scale(counts);
  Plane plane(counts.size());
  for (size_t i = 0; i < counts.size(); ++i)
    plane[i] = counts[i] > 0 ? float(std::min(double(counts[i]) / end, 1.0)) : 0;
  DisplayImage image = heatmap(plane, width, height);
  draw_scale_bar(image, {title, "0", end >= 2 ? fmt::format("{:.0f}", end / 2) : "",
                         fmt::format("{:.0f}{}", end, cut ? "+" : ""), false});
  return image;
}

}  // namespace candela
