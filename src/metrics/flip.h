#pragma once
#include <vector>

#include "metrics/planes.h"

namespace candela {

// 0.7 m from a display that is 0.7 m and 3840 pixels wide: 67.02 pixels a degree.
inline constexpr double flip_pixels_per_degree = 0.7 * (3840 / 0.7) * (3.14159265358979323846 / 180);

// LDR-FLIP (Andersson, Nilsson, Akenine-Moeller, Oskarsson, Aastroem, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", 2020): the difference that a viewer notices when two images alternate, for each pixel, in [0,1].
// Takes sRGB-encoded planes in [0,1]; symmetric in its two images.
Plane flip_map(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height,
               double pixels_per_degree = flip_pixels_per_degree);
// The same of planes in [0,1] that are linear in light: what HDR-FLIP has after its tone curve.
Plane flip_map_of_linear(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height,
                         double pixels_per_degree = flip_pixels_per_degree);

// Mean of a map, in double and in a fixed order.
double flip_mean(const Plane& map, int width, int height);
// The value that the given fraction of the pixels stays under, linear between ranks.
double flip_percentile(const Plane& map, double fraction);

}  // namespace candela
