#include "techniques/technique.h"

namespace candela {

std::span<const Technique> techniques() {
  static constexpr Technique table[] = {
      {"brute-force", "forward shading, every light for every pixel: correct first, and the yardstick", brute_force},
  };
  return table;
}

}  // namespace candela
