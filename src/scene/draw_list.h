#pragma once
#include <cstdint>
#include <vector>

#include "scene/frame_data.h"

namespace candela {

// A run of consecutive draw items that share their pipeline state: one indirect draw call.
struct DrawBatch {
  Topology topology = Topology::triangles;
  AlphaMode alpha = AlphaMode::opaque;
  bool unlit = false, cull_back = true, mirrored = false;
  bool refracts = false;          // is drawn after what is seen through it
  bool relief = false;            // its surface lies below the mesh (docs/understanding/relief.md)
  uint32_t first = 0, count = 0;  // in the order of drawing
  bool same_state(const DrawBatch& o) const {
    return topology == o.topology && alpha == o.alpha && unlit == o.unlit && cull_back == o.cull_back &&
           mirrored == o.mirrored && refracts == o.refracts && relief == o.relief;
  }
  bool is_lines() const { return topology != Topology::triangles; }  // or points
  // Hides what is behind it.
  bool solid() const { return alpha != AlphaMode::blend && !refracts; }
  bool operator==(const DrawBatch&) const = default;
};

// Consecutive items in the order of drawing: posed by the host, or those of a group whose sections share their state,
// instance by instance.
struct DrawSpan {
  uint32_t first = 0, count = 0;
  int group = -1;         // of FrameData::item_groups; -1: the host's
  uint32_t source = 0;    // of the host's: into DrawList::order; else into DrawList::sections
  uint32_t sections = 0;  // of each instance
};

// The order in which items are drawn. Opaque and masked ones are grouped by state, stable within; blended ones come
// last, back to front by the depth of their bounds' centre, stable for equal depths, so a run ends wherever the state
// changes.
struct DrawList {
  std::vector<uint32_t> order;     // indices of FrameData::items
  std::vector<DrawSpan> spans;     // of all items, those of groups among them
  std::vector<uint32_t> sections;  // of groups' meshes
  std::vector<DrawBatch> batches;
  uint32_t item_count() const { return spans.empty() ? 0 : spans.back().first + spans.back().count; }
  void clear() { order.clear(), spans.clear(), sections.clear(), batches.clear(); }
};
// refraction: surfaces that let light through are drawn so. list: whatever it held, its memory is used again.
void make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction, DrawList& list);
inline DrawList make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction = false) {
  DrawList list;
  make_draw_list(scene, pose, frame, refraction, list);
  return list;
}

// Whether a section lets light through (KHR_materials_transmission). Of blended ones the part that alpha covers does;
// through the rest the picture behind is seen as it is.
bool refracts(const MeshSection& section, const Material& material);

// Whether a section's surface lies below its triangles (CANDELA_relief).
bool has_relief(const MeshSection& section, const Material& material);

// Whether a section is drawn without lighting: its material says so, or it has no normals (lines and points).
bool is_unlit(const MeshSection& section, const Material* material);

}  // namespace candela
