#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "graph/handle.h"
#include "passes/shared/bvh_knobs.h"
#include "passes/shared/fog_view.h"
#include "passes/shared/knob_tables.h"
#include "passes/shared/light_knobs.h"

namespace candela {

// How a technique wants the frame's light lists laid out (passes/lights/light_grid.h).
enum class LightGridKind { none, clusters, tiles };

// Of how many lights buffers are: at most an eighth more, so that lights that come and go seldom change the plan.
inline uint32_t light_room(uint32_t lights) {
  const uint32_t step = std::max(std::bit_floor(lights) / 8, 1u);
  return (lights + step - 1) / step * step;
}

// Each light's box of cells (shared/lights.h), and their chunks.
struct LightBoxes {
  using MadeBy = std::tuple<LightKnobs>;
  BufferHandle bounds, chunks, dispatch;
};

// The shape of a frame's light lists, decided before the graph is built (passes/lights/light_grid.h).
struct LightGridShape {
  std::string reason;     // why there are no lists: every pixel walks every light. Empty: there are
  bool tiled = false;     // tiles bounded by the depth pre-pass, with columns behind them; otherwise clusters
  bool compact = false;   // otherwise bitmasks
  bool segments = false;  // compact ones are filled in light order, by segments of chunks; otherwise filled and sorted
  uint32_t tile_px = 0, tiles_x = 0, tiles_y = 0;
  uint32_t cells = 0, words = 0, most_chunks = 0;
  uint32_t most_bounds = 0;   // where a pass finds the boxes: room for them, else 0
  uint64_t most_entries = 0;  // sum over lights of the cells that each can touch: compact lists never need more
  LightKnobs knobs;
  bool operator==(const LightGridShape&) const = default;
};

// Ambient occlusion as shading reads it (shaders/lib/occlusion.glsl).
struct OcclusionTexels {
  using MadeBy = std::tuple<OcclusionKnobs>;
  ImageHandle open;
  uint32_t shape = 0;   // shared/occlusion.h
  bool traced = false;  // by rays where it is read; then there are no texels
};

// The trees that shading sends rays through (shaders/lib/trace.glsl); empty: it sends none.
struct TracedRays {
  using MadeBy = std::tuple<BvhKnobs>;
  BufferHandle trees, settings;
  uint32_t stack = 0;
  BvhKnobs tree;                                         // how they are built, for the plan
  bool blended = false;                                  // something lets a part of the light through
  bool suns = false, lamps = false;                      // whose shadows are traced
  bool suns_by_voxels = false, lamps_by_voxels = false;  // where cells of the view do not know them (LightVoxels)
  bool lights_apart = false;                             // a pass of its own sends those to lights (LightRays)
  bool lockstep = false;                                 // lanes of a subgroup run in step: the device is a CPU
  bool surfaces = false;                                 // rays look for surfaces, which are shaded where they are met
  // Lights with a size, whose shadows are soft; with maps they need the settings alone.
  bool soft_suns = false, soft_lamps = false;
  // What reaches shaders through the settings, for the plan.
  uint32_t occlusion_rays = 0, sun_samples = 0, lamp_samples = 0;
  bool operator==(const TracedRays&) const = default;
};

// What see-through surfaces leave of lights (passes/transparency/colored_shadows.h), beside their shadow maps; empty:
// they let all through.
struct ShadowColors {
  ImageHandle suns, lamps;
  bool bent = false;  // with the light that bodies bend
};

// What see-through surfaces leave of lights at each distance from them (passes/transparency/deep_shadows.h); empty:
// they let all through.
struct DeepShadowMaps {
  ImageHandle suns, lamps;
};

// Cells of the view that know which lights are seen from them (passes/shadows/light_voxels.h); empty: rays tell.
struct LightVoxels {
  BufferHandle states;
  bool halve = false;  // where a cell's points differ it lets half of the light through, and no ray is sent
};

// What rays to lights have found for the pixels of a visibility buffer (passes/shadows/light_rays.h); empty: shading
// sends them.
struct LightRecords {
  BufferHandle words;
  bool suffice = false;  // there is room for all of them
};

// What shading passes walk (shaders/lib/light_list.glsl), the depth maps of lights or the trees for their rays, the fog
// that all is seen through, and ambient occlusion. Empty handles: no lists, no shadows, nothing occludes.
struct Lighting {
  using MadeBy = std::tuple<LightKnobs, SunKnobs, LampKnobs, LightVoxelKnobs, LightRayKnobs, ColoredShadowKnobs,
                            DeepShadowKnobs, OcclusionKnobs, FogKnobs, BvhKnobs, ResolveKnobs, SupersampleKnobs>;
  BufferHandle cells;     // bitmasks of all cells, or where each cell's entries begin
  BufferHandle entries;   // compact: light indices, ascending inside a cell
  BufferHandle tiles;     // tiled: depths
  ImageHandle sun_maps;   // a layer a cascade (shaders/lib/sun_shadow.glsl)
  ImageHandle lamp_maps;  // tiles (shaders/lib/lamp_shadow.glsl)
  TracedRays rays;
  FogView fog;
  OcclusionTexels occlusion;   // for opaque and masked surfaces alone
  ShadowColors shadow_colors;  // the same
  DeepShadowMaps deep;         // for blended surfaces and the air
  LightVoxels voxels;          // the same
  LightRecords records;        // the same
  // For what is no opaque or masked surface: blended ones, the air, layers.
  Lighting unoccluded() const {
    Lighting without = *this;
    without.occlusion = {}, without.shadow_colors = {}, without.voxels = {}, without.records = {};
    return without;
  }
  // The same with lists of other cells.
  Lighting with_cells(const Lighting& of) const {
    Lighting with = *this;
    with.cells = of.cells, with.entries = of.entries, with.tiles = of.tiles;
    return with;
  }
};

}  // namespace candela
