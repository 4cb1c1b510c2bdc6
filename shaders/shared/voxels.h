#ifndef CANDELA_SHARED_VOXELS_H
#define CANDELA_SHARED_VOXELS_H
#include "shared/trace.h"
#include "shared/types.h"

SHARED_BEGIN

// Cells of the view that know of each light whether it is seen from them (passes/shadows/light_voxels.h). A buffer
// begins with a VoxelGrid; then come the tiles, a word for each cell that says where it is, and the cells' states: two
// bits a light, sixteen lights a word.
struct VoxelGrid {
  RaySettings settings;  // how shading sends rays: pc.rays serves both
  uint tile_px;
  uvec2 tiles;
  uint slice_shift;  // the slice of depth z is floatBitsToUint(z) >> slice_shift
  uint words;        // of a cell's states
  uint capacity;     // cells that the buffer has room for
};

// A square of pixels: its cells' keys, ascending. A key is 1 + 8 * slice + the side that the surface faces; 0: none.
struct VoxelTile {
  uint first;  // cell; those from the capacity on have no states
  uint count;
  uint keys[8];
};

struct VoxelPush {
  uint64_t keys;  // of a visibility buffer, where there is one
  uint64_t voxels, points, settings, groups, report;
  uvec2 tiles;
  uint words, capacity;
  uint depth;  // without keys the place of the depth among the pass's images
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint voxel_tile_cells = 8, most_voxel_points = 8, voxel_lights_a_word = 16, voxel_grid_bytes = 64,
                      voxel_tile_bytes = 40;
static_assert(sizeof(VoxelGrid) == 52 && sizeof(VoxelTile) == voxel_tile_bytes && sizeof(VoxelPush) == 72);
}  // namespace candela::shared
#else
const uint voxel_tile_cells = 8u, most_voxel_points = 8u, voxel_lights_a_word = 16u, voxel_grid_bytes = 64u,
           voxel_tile_bytes = 40u;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer VoxelGridRef { VoxelGrid g; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer VoxelTilesRef { VoxelTile t[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer VoxelWordRef { uint u; };
#endif

#endif
