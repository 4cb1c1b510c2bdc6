#ifndef CANDELA_SHARED_LIGHTS_H
#define CANDELA_SHARED_LIGHTS_H
#include "shared/types.h"

SHARED_BEGIN

// Where a shaded point finds its lights. The screen is cut into square tiles, and each tile either into depth slices
// (clusters) or to the depths that the depth pre-pass found (tiled). Cells are numbered x + tiles.x * (y + tiles.y *
// slice); in a tiled grid the columns of every depth, column_tiles by column_tiles tiles each, follow after the tiles.
struct LightGrid {
  uint mode;   // light_mode_*
  uint tiled;  // 1: tiles bounded by the depth pre-pass; 0: clusters
  uint tile_px;
  uvec2 tiles, columns;
  uint slices;
  uint slice_shift;  // slice of depth z: (floatBitsToUint(z) >> slice_shift) - slice_base, kept inside the grid
  int slice_base;
  uint words;         // of one cell's bitmask
  uint cap;           // entries of a cell that are walked; 0: all
  uint sift_over;     // in lists longer than this, points first look which lights reach them
  uint global_count;  // lights of every cell: words of a mask, or ascending indices
  vec2 px_scale;      // pixel = size/2 + px_scale * (x, -y)/z, or without the division for an orthographic camera
  float margin_px;    // by which every tile is widened against rounding
  float margin_z;     // the same for slices, a fraction of the depth
  uint64_t globals;
};

// What assignment knows of a light that does not reach everywhere: view space (x right, y up, z forward), inflated
// against rounding.
struct LightBounds {
  vec3 position;
  float radius;
  vec3 direction;              // unit
  float cos_outer, sin_outer;  // of the inflated half angle; cos_outer -2: no cone
  float z_low, z_high;         // depths that the light can reach
  uint light;                  // its place in the frame's lights
  uvec3 first, last;           // tiles and slice that it can touch, inclusive
};

// Up to light_chunk_cells consecutive cells of one light's box of cells, x first.
struct LightChunk {
  uint bounds, first;
  uint column;  // 1: of the columns instead of the tiles
};

// How many chunks there are, and the groups of threads for their cells: arguments of an indirect dispatch.
struct LightDispatch {
  uint chunks;
  uvec3 groups;
};

// A tile's depths, from all samples of its pixels.
struct TileDepth {
  float z_near, z_far;  // widened
  uint mask;            // which of the 32 slices between them hold a surface; 0: no surface
};

struct TileDepthPush {
  uint64_t tiles;
  uint depth;  // place in the pass's images
};
struct LightBoundsPush {
  uint64_t lights, bounds, chunks, dispatch;
  uint64_t bounds_count;
  uint light_count;
};
struct LightAssignPush {
  uint64_t bounds, chunks, dispatch, tiles;
  uint64_t lists;       // bitmasks, or counts of cells
  uint64_t sums, hits;  // compact lists: counts of light_scan_cells cells, and a bit a thread
};
// Segments of lists in light order (passes/lights/light_assign.h): rows of counts, one for each segment.
struct LightSegmentsPush {
  uint64_t bounds, chunks, dispatch, tiles;
  uint64_t rows, hits, offsets, entries;
  uint cells;
};
struct LightRowsPush {
  uint64_t rows, counts, sums;
  uint cells;
};
struct LightScanPush {
  uint64_t counts, sums, offsets;
  uint cells;
};
struct LightFillPush {
  uint64_t bounds, chunks, dispatch, hits, offsets, cursors, entries;
};
struct LightSortPush {
  uint64_t offsets, unsorted, entries, report;
  uint cells, cap;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint light_chunk_cells = 8, light_group = 64, light_scan_cells = 256, column_tiles = 4;
inline constexpr uint light_sort_cells = 8, light_sort_threads = 256;
inline constexpr uint light_segments = 16;
enum : uint { light_mode_all = 0, light_mode_bitmask = 1, light_mode_compact = 2 };
static_assert(sizeof(LightGrid) == 80 && offsetof(LightGrid, globals) == 72);
static_assert(sizeof(LightBounds) == 72 && sizeof(LightChunk) == 12 && sizeof(TileDepth) == 12);
static_assert(sizeof(LightDispatch) == 16 && sizeof(LightBoundsPush) == 48);
static_assert(sizeof(LightAssignPush) == 56 && sizeof(LightFillPush) == 56);
static_assert(sizeof(LightSegmentsPush) == 72 && sizeof(LightRowsPush) == 32);
// Groups beyond what one dimension of a dispatch takes on every device (65535) go to the second.
inline uvec2 light_threads(uint64_t threads, uint group = light_group) {
  const uint64_t groups = (threads + group - 1) / group;
  return {uint(groups < 65535 ? groups : 65535) * group, uint((groups + 65534) / 65535)};
}
}  // namespace candela::shared
#else
const uint light_chunk_cells = 8u, light_group = 64u, light_scan_cells = 256u, column_tiles = 4u;
const uint light_segments = 16u;
const uint light_sort_cells = 8u;      // that a group of light_sort looks through
const uint most_ranked_lights = 256u;  // of a list whose threads find their entries' places on their own
const uint light_mode_all = 0u, light_mode_bitmask = 1u, light_mode_compact = 2u;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightBoundsRef { LightBounds b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightChunksRef { LightChunk c[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightDispatchRef { LightDispatch d; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TileDepthsRef { TileDepth t[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer UintsRef { uint u[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ConstUintsRef { uint u[]; };
#endif

#endif
