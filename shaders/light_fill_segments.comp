#version 460
// Puts every light that light_assign_segments.comp found into its cells' lists, each group its segment of the chunks
// one after another: lists come out in light order.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shared/scene.h"
layout(push_constant, scalar) uniform Push { LightSegmentsPush pc; };
#include "lib/frame.glsl"
layout(local_size_x = light_chunk_cells) in;
#include "lib/light_chunk.glsl"
#include "lib/light_segment.glsl"

void main() {
  const uint row = gl_WorkGroupID.x * pc.cells, thread = gl_LocalInvocationIndex;
  uint first, last;
  segment_chunks(first, last);
  uint light = ~0u;
  LightBounds b;
  for (uint block = first; block < last; block += light_block_chunks) {
    const uint hits = ConstUintsRef(pc.hits).u[block / light_block_chunks * light_chunk_cells + thread];
    for (uint left = subgroupOr(hits); left != 0u; left &= left - 1u) {
      const uint bit = uint(findLSB(left));
      const LightChunk chunk = LightChunksRef(pc.chunks).c[block + bit];
      if (chunk.bounds != light) {
        subgroupMemoryBarrierBuffer();  // cells of one light are different ones; the next light's are other threads'
        subgroupBarrier();
        light = chunk.bounds;
        b = LightBoundsRef(pc.bounds).b[light];
      }
      ChunkCell c;
      if ((hits >> bit & 1u) != 0u && chunk_cell(chunk, b, thread, c)) {
        const uint before = UintsRef(pc.rows).u[row + c.cell];
        UintsRef(pc.rows).u[row + c.cell] = before + 1u;
        UintsRef(pc.entries).u[ConstUintsRef(pc.offsets).u[c.cell] + before] = b.light;
      }
    }
  }
}
