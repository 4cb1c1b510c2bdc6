#version 460
// One thread a light and cell of the box of cells that the light can touch: sets the light's bit in the cell's mask, or
// counts it. Bits and counts do not depend on the order in which threads arrive.
#include "shared/scene.h"
layout(push_constant, scalar) uniform Push { LightAssignPush pc; };
#include "lib/frame.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_bounds.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int TEST = 3;
layout(constant_id = 1) const int COMPACT = 0;
layout(constant_id = 2) const int TILED = 0;
layout(constant_id = 3) const int MASK = 0;
#include "lib/light_chunk.glsl"
#include "lib/light_touches.glsl"

void main() {
  const uint thread = chunk_thread();
  ChunkCell c;
  bool hit = false;
  const uint chunk = thread / light_chunk_cells;
  if (chunk < LightDispatchRef(pc.dispatch).d.chunks) {
    const LightChunk whose = LightChunksRef(pc.chunks).c[chunk];
    const LightBounds b = LightBoundsRef(pc.bounds).b[whose.bounds];
    hit = chunk_cell(whose, b, thread % light_chunk_cells, c) && touches(b, c);
    if (hit && COMPACT == 0) atomicOr(UintsRef(pc.lists).u[c.cell * frame.grid.words + b.light / 32u],
        1u << (b.light & 31u));
    if (hit && COMPACT != 0) {
      atomicAdd(UintsRef(pc.lists).u[c.cell], 1u);
      atomicAdd(UintsRef(pc.sums).u[c.cell / light_scan_cells], 1u);
    }
  }
  if (COMPACT != 0 && hit) atomicOr(UintsRef(pc.hits).u[thread / 32u], 1u << (thread & 31u));
}
