#include "techniques/technique.h"

namespace candela {

std::span<const Technique> techniques() {
  static constexpr Technique table[] = {
      {"clustered", "forward shading, lights listed by tile and depth slice: the default", forward,
       LightGridKind::clusters},
      {"forward-plus", "forward shading, lights listed by 16x16 tiles between the depths of their samples", forward,
       LightGridKind::tiles},
      {"brute-force", "forward shading, every light for every pixel: correct first, and the yardstick", forward,
       LightGridKind::none},
  };
  return table;
}

}  // namespace candela
