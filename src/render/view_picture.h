#pragma once
#include <string>

#include "image/image.h"
#include "passes/shared/pass.h"

namespace candela {

// What --view shows in the place of beauty where that is no light: 8 bits, RGB, opaque. Values that are not finite are
// magenta.
//
// A layer, by what its values are: counts and distances in a perceptual colour map with a scale (near is bright, black
// is nothing), directions from -1 to 1 as codes from 0 to 255, colours sRGB-encoded, shares as grey (code = 255 times
// the fraction), ids in a colour each, mattes in
// those of their two largest ids by coverage, motion as red and green from 0 to 1 about 0.5 with the farthest at the
// ends. `layer`: its channels alone; `name`: the layer's.
DisplayImage layer_view(const FloatImage& layer, LayerForm form, const std::string& name);

// An image of the frame, of any size, as large as it fits into width x height with black round it (nearest texel): one
// channel of floats in the colour map from its least to its largest finite value, ids in a colour each, else red,
// green and blue from 0 to 1, sRGB-encoded.
DisplayImage image_view(const FloatImage& image, int width, int height, const std::string& name);

}  // namespace candela
