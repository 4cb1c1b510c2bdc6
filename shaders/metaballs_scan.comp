#version 460
// Where each block's triangles begin among those of its body, and how many indices each of the body's items draws; one
// workgroup a body. Each thread has consecutive blocks.
#include "shared/metaballs.h"
layout(push_constant, scalar) uniform Push { MetaballsPush pc; };
layout(local_size_x = 256) in;

const uint chunk_indices = 3u * 4096u;
shared uint sum_of_thread[256];

void main() {
  const uint t = gl_LocalInvocationIndex;
  const MetaballBody body = MetaballBodiesRef(pc.bodies).b[gl_WorkGroupID.x];
  const uint each = (body.block_count + 255u) / 256u;
  const uint first = body.first_block + min(t * each, body.block_count);
  const uint end = body.first_block + min((t + 1u) * each, body.block_count);
  uint sum = 0u;
  for (uint b = first; b < end; ++b) sum += MetaballSumsRef(pc.sums).n[b];
  sum_of_thread[t] = sum;
  barrier();
  uint before = 0u, all = 0u;
  for (uint i = 0u; i < 256u; ++i) {
    if (i < t) before += sum_of_thread[i];
    all += sum_of_thread[i];
  }
  for (uint b = first; b < end; ++b) {
    MetaballSumsRef(pc.sums).n[pc.block_count + b] = before;
    before += MetaballSumsRef(pc.sums).n[b];
  }
  for (uint c = t; c < body.chunk_count; c += 256u) {
    const uint indices = 3u * all, drawn = c * chunk_indices;
    MetaballItemsRef(pc.items).i[body.first_item + c].index_count =
        indices > drawn ? min(indices - drawn, chunk_indices) : 0u;
  }
}
