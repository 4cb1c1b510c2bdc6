#pragma once
#include <array>
#include <glm/glm.hpp>

namespace candela {

// Real spherical harmonics up to l = 2 of unit d, Y00, Y1-1, Y10, Y11, Y2-2 ... Y22 (Ramamoorthi and Hanrahan, "An
// Efficient Representation for Irradiance Environment Maps", 2001).
inline std::array<double, 9> sh_basis(glm::dvec3 d) {
  return {0.282095,
          0.488603 * d.y,
          0.488603 * d.z,
          0.488603 * d.x,
          1.092548 * d.x * d.y,
          1.092548 * d.y * d.z,
          0.315392 * (3 * d.z * d.z - 1),
          1.092548 * d.x * d.z,
          0.546274 * (d.x * d.x - d.y * d.y)};
}

}  // namespace candela
