#version 460
// How many triangles each block of 8^3 cells has; one workgroup a block.
#include "shared/metaballs.h"
layout(push_constant, scalar) uniform Push { MetaballsPush pc; };
layout(local_size_x = 64) in;
#include "lib/metaballs.glsl"

shared uint count_of_row[64];

void main() {
  const uint t = gl_LocalInvocationIndex, b = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
  if (b >= pc.block_count) return;  // the whole workgroup
  const MetaballBlock block = MetaballBlocksRef(pc.blocks).b[b];
  fill_field(MetaballBodiesRef(pc.bodies).b[block.body], block, t, 64u);
  barrier();
  uint count = 0u;
  for (int x = 0; x < block_cells; ++x) count += triangles_of_cell(ivec3(x, t & 7u, t >> 3));
  count_of_row[t] = count;
  barrier();
  if (t != 0u) return;
  uint sum = 0u;
  for (uint i = 0u; i < 64u; ++i) sum += count_of_row[i];
  MetaballSumsRef(pc.sums).n[b] = sum;
}
