#pragma once
#include "image/image.h"
#include "metrics/planes.h"

namespace candela {

// A map of values in [0,1] as colours: black-violet for 0, pale yellow for 1.
DisplayImage heatmap(const Plane& map, int width, int height);

// Planes of R, G and B as 8 bits; values are clamped to [0,1].
DisplayImage as_display(const std::vector<Plane>& planes, int width, int height);

// Reference, test and heat map beside each other; alpha is dropped. Values are clamped to [0,1].
DisplayImage side_by_side(const std::vector<Plane>& reference, const std::vector<Plane>& test, const Plane& map,
                          int width, int height);

}  // namespace candela
