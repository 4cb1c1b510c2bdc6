#pragma once
#include <glm/glm.hpp>

#include "image/io.h"

namespace candela {

// A photographer's studio, for scenes that have neither lights nor a sky: soft boxes before something dark, so that
// metal and glass have shapes to mirror. Fixed to the world; glTF's front is +Z. A box is a rectangle in gnomonic
// coordinates about its own axis, whose edges fall off by a smoothstep over some degrees; behind the boxes radiance
// rises from the floor to the ceiling.

// Linear radiance, grey, from a direction of unit length in world axes. 1 is white at exposure 0.
double studio_radiance(glm::dvec3 direction);

// The same as an equirectangular image (scene/environment.h) of rgba32f: means over texels.
DecodedImage studio_image(int width, int height);

}  // namespace candela
