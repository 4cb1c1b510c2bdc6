#pragma once
#include <span>

#include "image/image.h"

namespace candela {

// Counts of every pixel (a heatmap layer) as colours of a perceptual map, black for 0, with a legend in the lower left
// corner where the image is large enough: the scale runs to the next 1, 2 or 5 times a power of ten above the largest
// count. 8 bits, RGB.
DisplayImage count_view(std::span<const float> counts, int width, int height);

// The end of that scale; at least 1.
double count_scale(std::span<const float> counts);

}  // namespace candela
