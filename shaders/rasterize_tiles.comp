#version 460
// Of how many workgroups rasterize_large.comp is.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { RasterizePush pc; };
#include "lib/large_triangles.glsl"
layout(local_size_x = 1) in;

void main() {
  const LargeCount large = large_count();
  const uint64_t chunks = (large.tiles + raster_chunk - 1u) / raster_chunk;
  const uint row = 32768u;  // below what one dimension of a dispatch takes on every device
  TileGroupsRef(pc.groups).g =
      TileGroups(uint(min(chunks, uint64_t(row))), uint(min((chunks + row - 1u) / row, uint64_t(row))), 1u);
}
