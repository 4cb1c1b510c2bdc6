#version 460
// Where each cell's list begins: the sum of the counts before it (exclusive prefix sum). In two levels, as Merrill and
// Grimshaw 2009 scan inside a group, with one leader a run of cells: drivers compile a barrier in a loop slowly.
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightScanPush pc; };
layout(local_size_x = 256) in;

const uint leaders = 16u, run_cells = light_scan_cells / leaders;
shared uint part[light_scan_cells];    // of the groups before this one, by thread
shared uint prefix[light_scan_cells];  // counts, then their sums inside a run
shared uint run_part[leaders], run_count[leaders];

void main() {
  const uint t = gl_LocalInvocationIndex, g = gl_WorkGroupID.x, cell = g * light_scan_cells + t;
  uint sum = 0u;
  for (uint i = t; i < g; i += light_scan_cells) sum += ConstUintsRef(pc.sums).u[i];
  const uint count = cell < pc.cells ? ConstUintsRef(pc.counts).u[cell] : 0u;
  part[t] = sum;
  prefix[t] = count;
  barrier();
  if (t < leaders) {
    const uint first = min(t, leaders - 1u) * run_cells;  // lavapipe loads for threads that are not here
    uint parts = 0u, counts = 0u;
    for (uint i = first; i < first + run_cells; ++i) {
      parts += part[i];
      counts += prefix[i];
      prefix[i] = counts;
    }
    run_part[t] = parts;
    run_count[t] = counts;
  }
  barrier();
  uint before = 0u, inside = prefix[t];
  for (uint run = 0u; run < leaders; ++run) {
    before += run_part[run];
    if (run < t / run_cells) inside += run_count[run];
  }
  if (cell < pc.cells) UintsRef(pc.offsets).u[cell] = before + inside - count;
  if (cell + 1u == pc.cells) UintsRef(pc.offsets).u[pc.cells] = before + inside;
}
