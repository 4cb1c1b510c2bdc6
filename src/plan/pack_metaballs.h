#pragma once
#include "plan/frame_upload.h"

namespace candela {

// What polygons of metaballs are made from (passes/geometry/metaballs.h). After the deformations' places, which it
// names.
void add_metaballs(const FrameData& data, const DrawList& draws, FrameUpload& upload);
bool same_metaballs(const std::vector<PosedMetaballs>& a, const std::vector<PosedMetaballs>& b);
// Of those that are drawn now, where they were; from the lattice's origin of now.
void add_metaballs_before(const FrameData& now, const FrameData& before, FrameUpload& upload);

}  // namespace candela
