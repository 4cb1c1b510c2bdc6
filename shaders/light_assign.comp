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

bool touches(LightBounds b, ChunkCell c) {
  const vec2 any_depth = vec2(-3.0e38, 3.0e38);
  if (TILED == 0) return light_touches(TEST, b, cell_slab(b, c.place.xy, c.place.xy, light_slice_depths(c.place.z)));
  if (c.column)
    return light_touches(TEST, b, cell_slab(b, c.place.xy * column_tiles,
        min(c.place.xy * column_tiles + column_tiles, frame.grid.tiles) - 1u, any_depth));
  const TileDepth t = TileDepthsRef(pc.tiles).t[c.cell];
  if (t.mask == 0u) return false;
  const Slab s = cell_slab(b, c.place.xy, c.place.xy, vec2(t.z_near, t.z_far));
  if (s.z_near > s.z_far) return false;
  if (MASK != 0) {
    const uint low = tile_slice(t, s.z_near), high = tile_slice(t, s.z_far);
    if ((t.mask & (0xffffffffu << low) & (0xffffffffu >> (31u - high))) == 0u) return false;
  }
  return light_touches(TEST, b, s);
}

void main() {
  const uint thread = chunk_thread();
  ChunkCell c;
  bool hit = false;
  if (chunk_cell(thread, c)) {
    const LightBounds b = LightBoundsRef(pc.bounds).b[c.bounds];
    hit = touches(b, c);
    if (hit && COMPACT == 0) atomicOr(UintsRef(pc.lists).u[c.cell * frame.grid.words + b.light / 32u],
        1u << (b.light & 31u));
    if (hit && COMPACT != 0) {
      atomicAdd(UintsRef(pc.lists).u[c.cell], 1u);
      atomicAdd(UintsRef(pc.sums).u[c.cell / light_scan_cells], 1u);
    }
  }
  if (COMPACT != 0 && hit) atomicOr(UintsRef(pc.hits).u[thread / 32u], 1u << (thread & 31u));
}
