#version 460
// Brings the entries of short lists into light order, so that the same frame gives the same bytes: each thread takes
// one entry to its place, the number of its list's lights before it. light_sort.comp orders long lists.
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightSortPush pc; };
layout(local_size_x = 64) in;

void main() {
  const uint entry = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (entry >= ConstUintsRef(pc.offsets).u[pc.cells]) return;
  uint low = 0u, high = pc.cells;  // the last cell whose list begins at or before the entry
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (ConstUintsRef(pc.offsets).u[middle] <= entry)
      low = middle;
    else
      high = middle;
  }
  const uint base = ConstUintsRef(pc.offsets).u[low], end = ConstUintsRef(pc.offsets).u[low + 1u];
  if (end - base > most_ranked_lights) return;
  const uint light = ConstUintsRef(pc.unsorted).u[entry];
  uint before = 0u;
  for (uint i = base; i < end; ++i) before += uint(ConstUintsRef(pc.unsorted).u[i] < light);
  UintsRef(pc.entries).u[base + before] = light;
}
