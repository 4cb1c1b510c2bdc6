#version 460
// Where each quad's fragments begin: the sum of those before it. In two levels and not in place, as light_scan.comp.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { FragmentsPush pc; };
layout(local_size_x = 256) in;
#include "lib/fragment_sums.glsl"

const uint runs = 16u, run_threads = fragments_group / runs;
shared uint part[fragments_group];    // of the groups before this one, by thread
shared uint counts[fragments_group];  // of this group's quads, by thread
shared uint run_part[runs], run_count[runs];

void main() {
  const uint t = gl_LocalInvocationIndex, group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uint quad_number = group * fragments_quads + 4u * t, all_quads = quad_count(pc.size_px);
  const uvec4 quads = fragments_of_quads(quad_number);
  uint sum = 0u;
  if (group * fragments_quads < all_quads)
    for (uint i = t; i < group; i += fragments_group)
      sum = plus(sum, CellWordsRef(pc.cells).w[first_sum(pc.size_px) + i]);
  part[t] = sum;
  counts[t] = plus(plus(quads.x, quads.y), plus(quads.z, quads.w));
  barrier();
  const uint run = t / run_threads, first = run * run_threads;
  if (t == first) {
    uint parts = 0u, all = 0u;
    for (uint i = first; i < first + run_threads; ++i) {
      parts = plus(parts, part[i]);
      all = plus(all, counts[i]);
    }
    run_part[run] = parts;
    run_count[run] = all;
  }
  barrier();
  uint before = 0u;
  for (uint r = 0u; r < runs; ++r) {
    before = plus(before, run_part[r]);
    if (r < run) before = plus(before, run_count[r]);
  }
  for (uint i = first; i < t; ++i) before = plus(before, counts[i]);
  for (uint q = 0u; q < 4u; ++q) {
    if (quad_number + q >= all_quads) return;
    CellWordsRef(pc.cells).w[first_offset(pc.size_px) + quad_number + q] = before;
    before = plus(before, quads[q]);
    if (quad_number + q + 1u == all_quads) CellWordsRef(pc.cells).w[1] = before;
  }
}
