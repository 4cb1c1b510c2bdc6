#version 460
// Sums each cell's counts over the segments: its length, and in each row how many entries the segments before have.
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightRowsPush pc; };
layout(local_size_x = 64) in;

void main() {
  const uint cell = gl_GlobalInvocationID.x;
  if (cell >= pc.cells) return;
  uint sum = 0u;
  for (uint segment = 0u; segment < light_segments; ++segment) {
    const uint at = segment * pc.cells + cell, count = UintsRef(pc.rows).u[at];
    UintsRef(pc.rows).u[at] = sum;
    sum += count;
  }
  UintsRef(pc.counts).u[cell] = sum;
  if (sum > 0u) atomicAdd(UintsRef(pc.sums).u[cell / light_scan_cells], sum);
}
