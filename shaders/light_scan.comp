#version 460
// Where each cell's list begins: the sum of the counts before it (exclusive prefix sum; Hillis and Steele 1986 inside a
// group).
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightScanPush pc; };
layout(local_size_x = 256) in;

shared uint prefix[light_scan_cells];

void main() {
  const uint t = gl_LocalInvocationIndex, g = gl_WorkGroupID.x, cell = g * light_scan_cells + t;
  uint sum = 0u;
  for (uint i = t; i < g; i += light_scan_cells) sum += ConstUintsRef(pc.sums).u[i];
  prefix[t] = sum;
  barrier();
  for (uint step = light_scan_cells / 2u; step > 0u; step /= 2u) {
    if (t < step) prefix[t] += prefix[t + step];
    barrier();
  }
  const uint before = prefix[0];
  barrier();
  const uint count = cell < pc.cells ? ConstUintsRef(pc.counts).u[cell] : 0u;
  prefix[t] = count;
  barrier();
  for (uint step = 1u; step < light_scan_cells; step *= 2u) {
    const uint left = t >= step ? prefix[t - step] : 0u;
    barrier();
    prefix[t] += left;
    barrier();
  }
  if (cell < pc.cells) UintsRef(pc.offsets).u[cell] = before + prefix[t] - count;
  if (cell + 1u == pc.cells) UintsRef(pc.offsets).u[pc.cells] = before + prefix[t];
}
