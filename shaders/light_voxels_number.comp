#version 460
// One workgroup: numbers the tiles' cells through, and says how many there are.
#include "shared/voxels.h"
layout(push_constant, scalar) uniform Push { VoxelPush pc; };
#include "lib/frame.glsl"
#include "lib/light_voxels.glsl"
layout(local_size_x = 256) in;
layout(constant_id = 31) const int TILE_PX = 8;
layout(constant_id = 32) const int POINTS = 4;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer ReportRef { uint cells, without; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer GroupsRef { uvec3 g; };

shared uint sums[256];

void main() {
  const uint t = gl_LocalInvocationIndex, tile_count = pc.tiles.x * pc.tiles.y;
  const uint fraction = (tile_count + 255u) / 256u, first = min(t * fraction, tile_count);
  const uint end = min(first + fraction, tile_count);
  VoxelTilesRef tiles = VoxelTilesRef(voxel_tiles_at(pc.voxels));
  uint sum = 0u;
  for (uint i = first; i < end; ++i) sum += tiles.t[i].count;
  sums[t] = sum;
  barrier();
  if (t == 0u) {
    uint total = 0u;
    for (uint i = 0u; i < 256u; ++i) {
      const uint own = sums[i];
      sums[i] = total;
      total += own;
    }
    const uint cells = min(total, pc.capacity);
    const uint groups = (cells * uint(POINTS) + 63u) / 64u;
    GroupsRef(pc.groups).g = uvec3(min(groups, 65535u), (groups + 65534u) / 65535u, 1u);
    if (pc.report != 0ul) {
      ReportRef(pc.report).cells = total;
      ReportRef(pc.report).without = total - cells;
    }
    VoxelGridRef(pc.voxels).g = VoxelGrid(RaySettingsRef(pc.settings).s, uint(TILE_PX), pc.tiles,
        voxel_slice_shift(uint(TILE_PX)), pc.words, pc.capacity);
  }
  barrier();
  uint next = sums[t];
  for (uint i = first; i < end; ++i) {
    tiles.t[i].first = next;
    for (uint k = 0u; k < tiles.t[i].count; ++k, ++next)
      if (next < pc.capacity)
        VoxelWordRef(voxel_places_at(pc.voxels, pc.tiles) + 4ul * uint64_t(next)).u = i * voxel_tile_cells + k + 1u;
  }
}
