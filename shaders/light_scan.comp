#version 460
// Where each cell's list begins: the sum of the counts before it (exclusive prefix sum). In two levels, as Merrill and
// Grimshaw 2009 scan inside a group: inside runs of cells, then over the runs. lavapipe compiles a barrier in a loop
// slowly. Nothing is summed in place: that form, with one thread a run, hangs an H200 (driver 580.159), and why is not
// known.
#extension GL_EXT_control_flow_attributes : require
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightScanPush pc; };
layout(local_size_x = 256) in;

const uint runs = 16u, run_cells = light_scan_cells / runs;
shared uint part[light_scan_cells];    // of the groups before this one, by thread
shared uint counts[light_scan_cells];
shared uint run_part[runs], run_count[runs];

void main() {
  const uint t = gl_LocalInvocationIndex, g = gl_WorkGroupID.x, cell = g * light_scan_cells + t;
  uint sum = 0u;
  for (uint i = t; i < g; i += light_scan_cells) sum += ConstUintsRef(pc.sums).u[i];
  const uint count = cell < pc.cells ? ConstUintsRef(pc.counts).u[cell] : 0u;
  part[t] = sum;
  counts[t] = count;
  barrier();
  const uint run = t / run_cells, first = run * run_cells;
  uint parts = 0u, inside = 0u;
  [[dont_unroll]] for (uint i = first; i < first + run_cells; ++i) {
    parts += part[i];
    if (i <= t) inside += counts[i];
  }
  if (t == first + run_cells - 1u) {
    run_part[run] = parts;
    run_count[run] = inside;
  }
  barrier();
  uint before = 0u;
  [[dont_unroll]] for (uint r = 0u; r < runs; ++r) {
    before += run_part[r];
    if (r < run) inside += run_count[r];
  }
  if (cell < pc.cells) UintsRef(pc.offsets).u[cell] = before + inside - count;
  if (cell + 1u == pc.cells) UintsRef(pc.offsets).u[pc.cells] = before + inside;
}
