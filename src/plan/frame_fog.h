#pragma once
#include "look/look.h"
#include "passes/volumes/fog.h"
#include "scene/frame_data.h"
#include "scene/view.h"
#include "shared/fog.h"

namespace candela {

// The fog of a frame's look in relative space, and the depths at which its light is kept. farthest_m: depth beyond
// which nothing is drawn, infinity when unknown.
shared::FogMedium frame_fog(const Look& look, const View& view, const FrameData& data, double farthest_m,
                            glm::uvec3 nodes, uint32_t sky_directions);

// How far a ray of the camera is followed through the light of lamps in the air.
float volumetric_reach_m(const Volumetric& look, const FrameData& data);

}  // namespace candela
