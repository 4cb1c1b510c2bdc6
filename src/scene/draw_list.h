#pragma once
#include <cstdint>
#include <vector>

#include "scene/frame_data.h"

namespace candela {

// A run of consecutive draw items that share their pipeline state: one indirect draw call.
struct DrawRun {
  Topology topology = Topology::triangles;
  AlphaMode alpha = AlphaMode::opaque;
  bool unlit = false, cull_back = true, mirrored = false;
  uint32_t first = 0, count = 0;  // into DrawList::order
  bool same_state(const DrawRun& o) const {
    return topology == o.topology && alpha == o.alpha && unlit == o.unlit && cull_back == o.cull_back &&
           mirrored == o.mirrored;
  }
};

// The order in which items are drawn. Opaque and masked ones are grouped by state, stable within; blended ones come
// last, back to front by the depth of their bounds' centre, stable for equal depths, so a run ends wherever the state
// changes.
struct DrawList {
  std::vector<uint32_t> order;  // indices of FrameData::items
  std::vector<DrawRun> runs;
};
DrawList make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame);

// Whether a section is drawn without lighting: its material says so, or it has no normals (lines and points).
bool is_unlit(const MeshSection& section, const Material* material);

}  // namespace candela
