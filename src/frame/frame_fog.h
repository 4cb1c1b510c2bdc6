#pragma once
#include "passes/volumes/fog.h"
#include "scene/frame_data.h"
#include "scene/look.h"
#include "scene/view.h"
#include "shared/fog.h"

namespace candela {

// The fog of a frame's look in relative space, and the depths at which its light is kept. farthest_m: depth beyond
// which nothing is drawn, infinity when unknown.
shared::FogMedium frame_fog(const Look& look, const View& view, const FrameData& data, double farthest_m,
                            glm::uvec3 nodes, uint32_t sky_directions);

}  // namespace candela
