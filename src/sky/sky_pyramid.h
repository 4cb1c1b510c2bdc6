#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "image/sky_texel.h"

namespace candela {

// An equirectangular sky in floats, axes as equirect_direction() has them. A register a texel.
struct SkyLevel {
  int width = 0, height = 0;
  std::vector<SkyTexel> texels;
  const SkyTexel& at(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
  double solid_angle(int row) const;  // of one texel
  glm::dvec3 direction(int x, int y) const;
};

// The sky at a power of two of texels, from 64x32 to 2048x1024: as it is where it has such a size, bilinear between its
// texels where it has fewer, means of them, weighed by their solid angles, where it has more.
SkyLevel sky_level(const DecodedImage& image);

// The sky and its halves down to 4x2. Each texel is the mean of its four, weighed by their solid angles.
std::vector<SkyLevel> sky_pyramid(SkyLevel sky);

}  // namespace candela
