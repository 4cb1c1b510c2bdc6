#pragma once
#include "image/io.h"

namespace candela {

// The sky's mean about each direction under exp(cos(angle) / deviation^2), which is a Gaussian of that standard
// deviation on the sphere (Fisher, "Dispersion on a Sphere", 1953). At as many texels as the blur leaves detail for;
// kept is all within 3.2 deviations.
DecodedImage blurred_sky(const DecodedImage& sky, double deviation_rad);

}  // namespace candela
