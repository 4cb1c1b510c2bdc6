#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "render/reference_frame.h"

namespace candela {

// Layers of the reference that `render` has too: depth, normal, albedo, object_id, material_id, emission, in its units
// and channels.
const std::vector<std::string>& surface_layer_names();

// Adds those of `layers` that are surface layers. type: of normal and colours; depth is always float.
void add_surface_layers(FloatImage& image, const ReferenceFrame& frame, const std::vector<std::string>& layers,
                        ChannelType type);

}  // namespace candela
