#include "scene/light_instances.h"

#include <cmath>

namespace candela {

double modulation_factor(const LightModulation& modulation, double time_s) {
  const double cycles = time_s / double(modulation.period_s) + double(modulation.phase);
  const double triangle = 1 - std::abs(2 * (cycles - std::floor(cycles)) - 1);  // 0, 1 half a period later, 0
  return 1 - double(modulation.depth) * triangle * triangle * (3 - 2 * triangle);
}

}  // namespace candela
