#include <algorithm>
#include <cmath>

#include "passes/lights/light_grid.h"

// apply_light_floor() of light_grid.h.
namespace candela {

uint32_t apply_light_floor(std::vector<LightItem>& lights, float floor_lux) {
  uint32_t count = 0;
  if (!(floor_lux > 0)) return count;
  for (LightItem& l : lights) {
    if (l.type == LightType::directional || std::isfinite(l.range_m) || l.inner_m > 0) continue;
    const double brightest = double(std::max(l.intensity.x, std::max(l.intensity.y, l.intensity.z)));
    l.range_m = float(std::min(std::sqrt(brightest / double(floor_lux)), 1e18));
    ++count;
  }
  return count;
}

}  // namespace candela
