#version 460
// What light_assign.comp does for compact lists, by groups of one subgroup, each of which goes through a segment of the
// chunks one after another: what it reads of a light is the same for all its threads, and its row of counts is its own,
// so that nothing is atomic. Where a CPU runs the shader, gathers and atomics are dearer than the tests.
#extension GL_KHR_shader_subgroup_basic : require
#include "shared/scene.h"
layout(push_constant, scalar) uniform Push { LightSegmentsPush pc; };
#include "lib/frame.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_bounds.glsl"
layout(local_size_x = light_chunk_cells) in;
layout(constant_id = 0) const int TEST = 3;
layout(constant_id = 2) const int TILED = 0;
layout(constant_id = 3) const int MASK = 0;
#include "lib/light_chunk.glsl"
#include "lib/light_segment.glsl"
#include "lib/light_touches.glsl"

void main() {
  const uint row = gl_WorkGroupID.x * pc.cells, thread = gl_LocalInvocationIndex;
  uint first, last;
  segment_chunks(first, last);
  uint light = ~0u;
  LightBounds b;
  for (uint block = first; block < last; block += light_block_chunks) {
    uint hits = 0u;
    for (uint i = block; i < min(block + light_block_chunks, last); ++i) {
      const LightChunk chunk = LightChunksRef(pc.chunks).c[i];
      if (chunk.bounds != light) {
        subgroupMemoryBarrierBuffer();  // cells of one light are different ones; the next light's are other threads'
        subgroupBarrier();
        light = chunk.bounds;
        b = LightBoundsRef(pc.bounds).b[light];
      }
      ChunkCell c;
      if (chunk_cell(chunk, b, thread, c) && touches(b, c)) {
        UintsRef(pc.rows).u[row + c.cell] += 1u;
        hits |= 1u << (i - block);
      }
    }
    UintsRef(pc.hits).u[block / light_block_chunks * light_chunk_cells + thread] = hits;
  }
}
