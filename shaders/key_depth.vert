#version 460
// The marked tiles of the picture, two triangles each; the others are nothing.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { SamplesPush pc; };

void main() {
  const uint tile = uint(gl_InstanceIndex), corner = uint(gl_VertexIndex);
  if (TilesRef(pc.tiles).t[tile] == 0u) {
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
    return;
  }
  const uint across = (pc.size_px.x + depth_tile_px - 1u) / depth_tile_px;
  const uvec2 low = depth_tile_px * uvec2(tile % across, tile / across);
  const uvec2 high = min(low + depth_tile_px, pc.size_px);
  const bvec2 far = bvec2(corner == 1u || corner == 2u || corner == 4u, corner == 2u || corner == 4u || corner == 5u);
  gl_Position = vec4(2.0 * vec2(mix(low, high, far)) / vec2(pc.size_px) - 1.0, 0.0, 1.0);
}
