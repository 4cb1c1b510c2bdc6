#pragma once
#include <vector>

#include "metrics/planes.h"

namespace candela {

// Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to
// Structural Similarity", 2004) of two display-encoded RGB images: Rec.709 luma in [0,1], Gaussian window of 11x11
// pixels with sigma 1.5, C1 = 0.01^2, C2 = 0.03^2, averaged over the pixels whose window lies inside the image. Along a
// side shorter than the window, all pixels count and the edge repeats.
double ssim(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height);

}  // namespace candela
