// From a thread to a light and one cell of its box. Needs the push constants chunks, bounds and
// dispatch.
struct ChunkCell {
  uint bounds;      // whose
  uint cell;
  uvec3 place;      // tile and slice, or column
  bool column;
};

uint chunk_thread() { return (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * light_group + gl_LocalInvocationIndex; }

bool chunk_cell(uint thread, out ChunkCell c) {
  if (thread / light_chunk_cells >= LightDispatchRef(pc.dispatch).d.chunks) return false;
  const LightChunk chunk = LightChunksRef(pc.chunks).c[thread / light_chunk_cells];
  const LightBounds b = LightBoundsRef(pc.bounds).b[chunk.bounds];
  c.bounds = chunk.bounds;
  c.column = chunk.column != 0u;
  const uvec3 first = c.column ? uvec3(b.first.xy / column_tiles, 0u) : b.first;
  const uvec3 count = (c.column ? uvec3(b.last.xy / column_tiles, 0u) : b.last) - first + 1u;
  const uint i = chunk.first + thread % light_chunk_cells;
  if (i >= count.x * count.y * count.z) return false;
  c.place = first + uvec3(i % count.x, i / count.x % count.y, i / (count.x * count.y));
  const uvec2 tiles = frame.grid.tiles;
  c.cell = c.column ? tiles.x * tiles.y + c.place.x + frame.grid.columns.x * c.place.y : c.place.x +
      tiles.x * (c.place.y + tiles.y * c.place.z);
  return true;
}
