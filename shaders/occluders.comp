#version 460
// A bit for each item whose depth is drawn first: of those in view, opaque and masked ones whose boxes cover much.
#include "lib/frame.glsl"
#include "shared/cull.h"
layout(push_constant, scalar) uniform Push { OccludersPush pc; };
#include "lib/cull_masks.glsl"
#include "lib/projected_box.glsl"
layout(local_size_x = 256) in;

bool covers_much(Item item) {
  const ProjectedBox box = project_box(item, pc.subsample_ndc);
  const vec2 side_px = vec2(box.last_px - box.first_px + 1);
  return !box.bounded || side_px.x * side_px.y >= pc.first_phase_px;
}

void main() {
  const uint group = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
  if (group >= pc.group_count) return;  // the whole workgroup
  const CullGroup of = CullGroupsRef(pc.groups).g[group];
  const bool chosen = of.hides != 0u && item_bit(pc.kept, group) &&
      covers_much(ItemsRef(frame.items).i[of.first_item + gl_LocalInvocationIndex]);
  write_masks(chosen, pc.masks, pc.survivors, group);
}
