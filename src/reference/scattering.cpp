#include "reference/scattering.h"

#include <algorithm>
#include <cmath>

namespace candela::reference {

double single_scatter_albedo(double multi) {
  const double root = 4.09712 + 4.20863 * multi - std::sqrt(9.59217 + multi * (41.6808 + 17.7126 * multi));
  return std::clamp(1 - root * root, 0.0, 1.0);
}

BodyMedium body_medium(const Material& m) {
  BodyMedium medium;
  for (int c = 0; c < 3; ++c) {
    const double color = std::clamp(double(m.attenuation_color[c]), 0.0, 1.0);
    const double per_m = color < 1 ? -std::log(color) / double(m.attenuation_distance_m) : 0;
    medium.extinction[c] = std::min(per_m, most_extinction_per_m);
    medium.scattering[c] = medium.extinction[c] * single_scatter_albedo(double(m.scattering.color[c]));
  }
  medium.anisotropy = m.scattering.anisotropy;
  return medium;
}

SlabShares slab_shares(const BodyMedium& medium, double thickness_m) {
  SlabShares out;
  for (int c = 0; c < 3; ++c) {
    const double turned = 0.75 * medium.scattering[c] * (1 - medium.anisotropy) * thickness_m;
    const double lost = 2 * (medium.extinction[c] - medium.scattering[c]) * thickness_m;
    const double depth = std::sqrt(lost * (lost + 2 * turned));
    // The hyperbolic sine over its argument, and the cosine, of the depth, both times e^-depth.
    const double sine = depth > 0 ? -std::expm1(-2 * depth) / (2 * depth) : 1, cosine = (1 + std::exp(-2 * depth)) / 2;
    const double sum = (turned + lost) * sine + cosine;
    out.reflected[c] = turned * sine / sum;
    out.through[c] = std::exp(-depth) / sum;
  }
  return out;
}

SlabShares between_walls(const SlabShares& slab, const SlabShares& wall) {
  const glm::dvec3 back = 1.0 / glm::max(1.0 - slab.reflected * wall.reflected, glm::dvec3(1e-6));
  const SlabShares on_wall{slab.reflected + slab.through * slab.through * wall.reflected * back,
                           slab.through * wall.through * back};
  const glm::dvec3 out = 1.0 / glm::max(1.0 - on_wall.reflected * wall.reflected, glm::dvec3(1e-6));
  return {wall.reflected + wall.through * wall.through * on_wall.reflected * out, wall.through * on_wall.through * out};
}

}  // namespace candela::reference
