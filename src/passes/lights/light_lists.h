#pragma once
#include <cstdint>
#include <string>

#include "graph/handle.h"
#include "passes/lights/light_knobs.h"
#include "passes/volumes/fog_view.h"

namespace candela {

// How a technique wants the frame's light lists laid out (passes/lights/light_grid.h).
enum class LightGridKind { none, clusters, tiles };

// The shape of a frame's light lists, decided before the graph is built (passes/lights/light_grid.h).
struct LightGridShape {
  std::string reason;    // why there are no lists: every pixel walks every light. Empty: there are
  bool tiled = false;    // tiles bounded by the depth pre-pass, with columns behind them; otherwise clusters
  bool compact = false;  // otherwise bitmasks
  uint32_t tile_px = 0, tiles_x = 0, tiles_y = 0;
  uint32_t cells = 0, words = 0, chunks = 0, most_chunks = 0;
  uint64_t most_entries = 0;  // sum over lights of the cells that each can touch: compact lists never need more
  LightKnobs knobs;
};

// Ambient occlusion as shading reads it (shaders/lib/occlusion.glsl).
struct OcclusionTexels {
  ImageHandle open;
  uint32_t shape = 0;  // shared/occlusion.h
};

// What shading passes walk (shaders/lib/light_list.glsl), the depth maps of lights, the fog that all is seen through,
// and ambient occlusion. Empty handles: no lists, no shadows, nothing occludes.
struct CellLists {
  BufferHandle cells;     // bitmasks of all cells, or where each cell's entries begin
  BufferHandle entries;   // compact: light indices, ascending inside a cell
  BufferHandle tiles;     // tiled: depths
  ImageHandle sun_maps;   // a layer a cascade (shaders/lib/sun_shadow.glsl)
  ImageHandle lamp_maps;  // tiles (shaders/lib/lamp_shadow.glsl)
  FogView fog;
  OcclusionTexels occlusion;  // for opaque and masked surfaces alone
};

}  // namespace candela
