#version 460
// Puts every light that light_assign found into its cells' lists, in the order in which threads arrive; light_sort
// orders them.
#include "shared/scene.h"
layout(push_constant, scalar) uniform Push { LightFillPush pc; };
#include "lib/frame.glsl"
layout(local_size_x = 64) in;
#include "lib/light_chunk.glsl"

void main() {
  const uint thread = chunk_thread();
  if (thread / light_chunk_cells >= LightDispatchRef(pc.dispatch).d.chunks) return;
  if ((ConstUintsRef(pc.hits).u[thread / 32u] >> (thread & 31u) & 1u) == 0u) return;
  const LightChunk chunk = LightChunksRef(pc.chunks).c[thread / light_chunk_cells];
  const LightBounds b = LightBoundsRef(pc.bounds).b[chunk.bounds];
  ChunkCell c;
  chunk_cell(chunk, b, thread % light_chunk_cells, c);
  const uint place = ConstUintsRef(pc.offsets).u[c.cell] + atomicAdd(UintsRef(pc.cursors).u[c.cell], 1u);
  UintsRef(pc.entries).u[place] = b.light;
}
