#pragma once
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/reused.h"
#include "passes/shared/views.h"
#include "plan/caster_hash.h"
#include "plan/lamp_pool.h"
#include "scene/draw_list.h"
#include "scene/pose.h"
#include "shared/cull.h"
#include "shared/scene.h"

namespace candela {

// The frame's views beside the camera's, as uploaded, and the room that each of them gets for its draw commands.
struct FrameViews {
  std::vector<shared::View> table;
  std::vector<uint32_t> first_command;  // of each view and run, and the end of all: the buffer of regions
};

// Neighbours among the items of a run, where a pass poses them: a box about all of theirs, relative space.
struct ItemCluster {
  uint32_t run = 0, count = 0, node = 0;
  glm::dvec3 bounds_centre{0}, bounds_extent{0};
};
std::pmr::vector<ItemCluster> item_clusters(const FrameData& data, const DrawList& draws,
                                            std::pmr::memory_resource* memory = std::pmr::get_default_resource());

// What each view may draw of what stands and of what moves, for keys of its texels.
struct ViewCasters {
  const CasterHashes* hashes = nullptr;  // null: hashes are not asked for
  std::span<const uint32_t> moving;      // a bit for each node (FrameLamps::moving); empty: nothing moves
  struct OfView {
    CasterHash standing, moving;
    std::span<uint32_t> moving_counts;  // how many of those that move, by run; empty: none
  };
  std::pmr::vector<OfView> of_view;
  std::pmr::vector<uint32_t> counts;  // all views' moving_counts
  explicit ViewCasters(const CasterHashes* of = nullptr, std::span<const uint32_t> nodes = {},
                       std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : hashes(of), moving(nodes), of_view(memory), counts(memory) {}
  bool moves(uint32_t node) const { return !moving.empty() && (moving[node / 32] >> (node % 32) & 1u) != 0; }
};

// Room for the draw commands of every view and run: as many as the CPU counts with a test that never culls what the
// device keeps (its allowance for rounding is four times as wide), so nothing can run out on the device. Runs of
// line and point items get none: they cast no shadow. Of see-through ones neither, unless what they leave of the light
// is drawn (`see_through`). More than `budget` commands over all views is an error that names what is needed, at most
// what a 32-bit place can hold, and the knob that the budget is from. culling: 0 in the pass means that every item of a
// run that is drawn at all needs room. items: the host's, in the order of drawing; of clusters all items need room
// where any may.
// placed: has the views already.
Expected<void> place_views(FrameViews& placed, std::span<const shared::Item> items, std::span<const DrawBatch> runs,
                           bool culling, uint64_t budget, std::string_view knob = "sun.draws", bool see_through = false,
                           std::span<const ItemCluster> clusters = {}, ViewCasters* casters = nullptr);

bool casts_shadows(const DrawBatch& run);

// What a frame's shadow maps of one kind of light are, decided before the graph is built.
struct ShadowMaps {
  bool traced = false;           // shading sends rays; maps, where there are any, are for fog
  bool by_voxels = false;        // where cells of the view do not know what these find
  std::string absence;           // why there are none; empty: there are
  std::vector<uint32_t> lights;  // whose shadows they are, by their places in the frame's data
  FrameViews views;
  Reused<ViewImage> image;
  Notes notes;
  void clear() {
    traced = by_voxels = false;
    absence.clear(), lights.clear(), views.table.clear(), views.first_command.clear(), image.reset(), notes.clear();
  }
};
// What both kinds of maps depend on beside their own knobs.
struct MapOptions {
  int longer_side_px = 0;                 // of the picture
  double scene_size_m = 0;                // GeometryLayout::size_m
  bool culling = true;                    // the pass that culls does so
  bool see_through = false;               // see-through surfaces are drawn into the views
  bool floats = false;                    // maps are of plain floats, not of depths: those that compute draws
  const KeptLamps* kept_lamps = nullptr;  // null: maps of point and spot lights do not outlive the frame
  // Of each node whether it moves (scene/moving_nodes.h); empty: none does.
  std::span<const uint8_t> moving = {};
  TextureKnobs textures = {};  // that masks are read with
  ReliefKnobs relief = {};     // of a scene that has them
};
// Gives the views of the maps' image room for their draw commands. Errors: as place_views().
Expected<void> place_maps(ShadowMaps& maps, const FrameData& data, const DrawList& draws,
                          std::span<const shared::Item> items, const MapOptions& options, int draws_knob,
                          std::string_view knob_name, ViewCasters* casters = nullptr);

}  // namespace candela
