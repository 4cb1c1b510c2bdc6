#version 460
// Sums of the fragments of groups of quads, held where they would leave 31 bits, and the most of a quad.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { FragmentsPush pc; };
layout(local_size_x = 256) in;
#include "lib/fragment_sums.glsl"

shared uint sums[fragments_group];

void main() {
  const uint t = gl_LocalInvocationIndex, group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const uvec4 quads = fragments_of_quads(group * fragments_quads + 4u * t);
  sums[t] = plus(plus(quads.x, quads.y), plus(quads.z, quads.w));
  const uint most = max(max(quads.x, quads.y), max(quads.z, quads.w));
  if (most > 0u) atomicMax(CellWordsRef(pc.cells).w[2], most);
  barrier();
  if (t > 0u) return;
  uint sum = 0u;
  for (uint i = 0u; i < fragments_group; ++i) sum = plus(sum, sums[i]);
  if (group * fragments_quads < quad_count(pc.size_px)) CellWordsRef(pc.cells).w[first_sum(pc.size_px) + group] = sum;
}
