#pragma once
#include <glm/glm.hpp>

#include "scene/frame_data.h"
#include "scene/view.h"

namespace candela {

// Where the trees for rays have their origin, in the world: the point next to the camera on a grid of a power of two,
// about a sixty-fourth of the scene wide. So trees stay the same while the camera moves nearby, and floats are nearly
// as exact about the camera as where it is the origin. In scenes far wider than most of their items the grid is about
// the size of these. A function of the frame alone. data: of the view.
glm::dvec3 trace_origin(const FrameData& data, const View& view);

}  // namespace candela
