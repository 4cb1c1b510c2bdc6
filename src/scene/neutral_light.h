#pragma once
#include "scene/frame_data.h"

namespace candela {

// Whether the file has any light at all: one that is dark at this time must not bring the neutral light.
bool has_light(const Scene& scene);

// A key light over the viewer's shoulder for scenes without light, beside neutral_ambient().
void add_neutral_light(const View& view, FrameData& data);

}  // namespace candela
