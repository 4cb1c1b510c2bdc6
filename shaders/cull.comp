#version 460
// A bit for each view and item that stays, and how many stay of each group of items. cull_compact turns the counts into
// stable places.
#include "lib/cull.glsl"
#include "lib/cull_masks.glsl"

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint flat_place = flat_group();
  if (flat_place >= pc.group_count * pc.view_count) return;  // the whole workgroup
  const uint view = HAS_VIEW_TABLE != 0 ? flat_place / pc.group_count : 0u;
  const CullGroup group = CullGroupsRef(pc.groups).g[flat_place - view * pc.group_count];
  uint item_count = group.item_count;
  if (HAS_VIEW_TABLE != 0) {  // a run without room is one that the view does not draw
    const uint region = view * pc.run_count + group.run;
    if (RegionsRef(pc.regions).first[region] == RegionsRef(pc.regions).first[region + 1u]) item_count = 0u;
  }
  const bool stays = t < item_count && item_survives(view, group.first_item + t);
  write_masks(stays, pc.masks, pc.survivors, flat_place);
}
