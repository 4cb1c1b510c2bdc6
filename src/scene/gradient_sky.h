#pragma once
#include "image/io.h"
#include "look/look.h"

namespace candela {

// The fraction of zenith (0), horizon (1) and ground (2) that a gradient sky has at a sine of the elevation. They sum
// to 1.
double gradient_share(int band, double exponent, double sine);

// That share as an equirectangular image, the mean over each row's height; all columns are alike.
DecodedImage gradient_image(int band, double exponent, int width, int height);

}  // namespace candela
