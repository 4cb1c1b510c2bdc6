#pragma once
#include <span>
#include <string>

#include "image/image.h"

namespace candela {

// Counts of every pixel (a heatmap layer) as colours of a perceptual map, black for 0, with title, scale and unit in
// the lower left corner where the image is large enough. A few large counts would leave the rest nearly black: the
// scale ends at a round number from the 99th percentile of what is not 0, and what is beyond has the colour of its end,
// written with a plus. 8 bits, RGB.
DisplayImage count_view(std::span<const float> counts, int width, int height, const std::string& title);
// What a layer counts, in capitals: "LIGHTS LISTED PER PIXEL".
std::string count_title(const std::string& layer);

// The end of that scale: 1, 2, 4, 6 or 8 times a power of ten.
struct CountScale {
  double end = 1;
  bool cut = false;  // there are counts beyond
};
CountScale count_scale(std::span<const float> counts);

}  // namespace candela
