#pragma once
#include <array>
#include <glm/glm.hpp>

#include "image/io.h"

namespace candela {

// Spherical harmonics up to l = 2 of an environment's radiance, convolved with the clamped cosine and divided by pi:
// the mean radiance that a white diffuse surface reflects (Ramamoorthi and Hanrahan 2001). Order: 1, y, z, x, xy, yz,
// 3z^2-1, xz, x^2-y^2.
using AmbientSh = std::array<glm::vec3, 9>;

// The direction of an equirectangular texel: the image's middle is +X, u grows towards +Z, the top row is +Y.
glm::dvec3 equirect_direction(double u, double v);

// Projects an equirectangular image of floats or half floats, in double with exact solid angles of the rows.
AmbientSh project_environment(const DecodedImage& image);

// The same of that sky turned about +Y, counter-clockwise seen from above, and made brighter.
AmbientSh turned(const AmbientSh& sh, double angle_rad, double times);

// What a frame without any light gets: radiance 0.7 from above fading to 0.2 from below, so that any object is seen.
AmbientSh neutral_ambient();

}  // namespace candela
