#version 460
// Marks the tiles of the picture that boxes of blended items in view may touch.
#include "lib/frame.glsl"
#include "shared/cull.h"
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { BlendedTilesPush pc; };
#include "lib/cull_masks.glsl"
#include "lib/projected_box.glsl"
layout(local_size_x = 256) in;

shared uvec4 boxes[cull_group_size];  // first and last tile, both in
shared uint box_count;

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint group = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
  if (group >= pc.group_count) return;  // the whole workgroup
  const CullGroup of = CullGroupsRef(pc.groups).g[group];
  if (of.is_blended == 0u) return;
  if (t == 0u) box_count = 0u;
  barrier();
  const uvec2 last = (frame.size_px - 1u) / depth_tile_px;
  if (item_bit(pc.kept, group)) {
    const ProjectedBox box = project_box(ItemsRef(frame.items).i[of.first_item + t], pc.subsample_ndc);
    boxes[atomicAdd(box_count, 1u)] = !box.bounded ? uvec4(0u, 0u, last)
        : uvec4(uvec2(box.first_px) / depth_tile_px, uvec2(box.last_px) / depth_tile_px);
  }
  barrier();
  TilesRef tiles = TilesRef(pc.tiles);
  for (uint b = 0u; b < box_count; ++b) {
    const uvec2 low = boxes[b].xy, size = boxes[b].zw - low + 1u;
    for (uint i = t; i < size.x * size.y; i += cull_group_size)
      atomicOr(tiles.t[(low.y + i / size.x) * (last.x + 1u) + low.x + i % size.x], 1u);
  }
}
