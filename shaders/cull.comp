#version 460
// Counts, for each group of items, how many survive the frustum test. cull_compact turns the counts into stable places.
#include "lib/cull.glsl"

shared uint survivors;

void main() {
  const uint g = group_index();
  if (g >= pc.group_count) return;  // the whole workgroup
  const CullGroup group = CullGroupsRef(pc.groups).g[g];
  if (gl_LocalInvocationIndex == 0u) survivors = 0u;
  barrier();
  if (gl_LocalInvocationIndex < group.item_count &&
      item_survives(group.first_item + gl_LocalInvocationIndex)) atomicAdd(survivors, 1u);
  barrier();
  if (gl_LocalInvocationIndex == 0u) CountsRef(pc.survivors).n[g] = survivors;
}
