#include "plan/trace_origin.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace candela {

glm::dvec3 trace_origin(const FrameData& data, const View& view) {
  constexpr double part = 64;      // of the scene's diagonal
  constexpr double widest = 1024;  // in items of middle size
  std::vector<double> sizes;
  DAabb all;
  for (const DrawItem& item : data.items) {
    const DAabb box{glm::dvec3(item.bounds_relative.min), glm::dvec3(item.bounds_relative.max)};
    const double size = 2 * glm::length(box.extent());
    if (!std::isfinite(size)) continue;
    sizes.push_back(size);
    all.add(box);
  }
  if (sizes.empty()) return view.position;
  const auto middle = sizes.begin() + std::ptrdiff_t(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double width = std::min(2 / part * glm::length(all.extent()), widest * *middle);
  if (!(width > 0) || !std::isfinite(width)) return view.position;
  const double step = std::exp2(std::ceil(std::log2(width)));
  const glm::dvec3 origin = glm::round(view.position / step) * step;
  return glm::all(glm::lessThan(glm::abs(origin), glm::dvec3(1e18))) ? origin : view.position;
}

}  // namespace candela
