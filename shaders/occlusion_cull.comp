#version 460
// Of the items in view, a bit for each that the depth pyramid does not hide, and for each of these that is no occluder:
// an item is hidden where its nearest depth lies behind the farthest of all samples that its box may cover.
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "shared/cull.h"
layout(push_constant, scalar) uniform Push { OcclusionCullPush pc; };
#include "lib/cull_masks.glsl"
#include "lib/projected_box.glsl"
layout(local_size_x = 256) in;

bool is_hidden(Item item) {
  const ProjectedBox box = project_box(item, pc.subsample_ndc);
  if (!box.bounded) return false;
  // The finest level where it covers four texels a side at most; the first has texels of two pixels a side.
  int level = 0;
  ivec2 first = box.first_px >> 1, last = box.last_px >> 1;
  while (any(greaterThan(last - first, ivec2(3)))) {
    first >>= 1, last >>= 1;
    ++level;
  }
  float farthest = 1.0;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      farthest = min(farthest, texelFetch(pass_images[pc.pyramid], ivec2(x, y), level).r);
  return box.nearest < farthest;
}

void main() {
  const uint group = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
  if (group >= pc.group_count) return;  // the whole workgroup
  const CullGroup of = CullGroupsRef(pc.groups).g[group];
  const bool kept = item_bit(pc.kept, group);
  const bool visible =
      kept && !(of.hides != 0u && is_hidden(ItemsRef(frame.items).i[of.first_item + gl_LocalInvocationIndex]));
  const bool drawn_first = item_bit(pc.occluders, group);
  const uint visible_count = write_masks(visible, pc.visible, pc.visible_survivors, group);
  const uint rest_count = write_masks(visible && !drawn_first, pc.rest, pc.rest_survivors, group);
  if (pc.report == 0ul || gl_LocalInvocationIndex != 0u) return;
  uint kept_count = 0u, occluder_count = 0u;
  for (uint w = 0u; w < cull_mask_words; ++w) {
    kept_count += uint(bitCount(MasksRef(pc.kept).m[group * cull_mask_words + w]));
    occluder_count += uint(bitCount(MasksRef(pc.occluders).m[group * cull_mask_words + w]));
  }
  OcclusionReportRef report = OcclusionReportRef(pc.report);
  atomicAdd(report.r.kept, kept_count);
  atomicAdd(report.r.occluders, occluder_count);
  atomicAdd(report.r.rest, rest_count);
  atomicAdd(report.r.hidden, kept_count - visible_count);
}
