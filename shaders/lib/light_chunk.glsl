// From a thread of a chunk to one cell of its light's box.
struct ChunkCell {
  uint cell;
  uvec3 place;      // tile and slice, or column
  bool column;
};

uint chunk_thread() { return (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * light_group + gl_LocalInvocationIndex; }

// a / b by floats, whose quotient is at most one off up to 2^24: vectors of a CPU have no division of integers.
uint quotient(uint a, uint b) {
  const uint q = uint((float(a) + 0.5) / float(b));
  return q * b > a ? q - 1u : (q + 1u) * b <= a ? q + 1u : q;
}

// The cell of a thread of a chunk; false where the light's box has no more cells.
bool chunk_cell(LightChunk chunk, LightBounds b, uint in_chunk, out ChunkCell c) {
  c.column = chunk.column != 0u;
  const uvec3 first = c.column ? uvec3(b.first.xy / column_tiles, 0u) : b.first;
  const uvec3 count = (c.column ? uvec3(b.last.xy / column_tiles, 0u) : b.last) - first + 1u;
  const uint i = chunk.first + in_chunk;
  if (i >= count.x * count.y * count.z) return false;
  const uint row = quotient(i, count.x), layer = quotient(row, count.y);
  c.place = first + uvec3(i - row * count.x, row - layer * count.y, layer);
  const uvec2 tiles = frame.grid.tiles;
  c.cell = c.column ? tiles.x * tiles.y + c.place.x + frame.grid.columns.x * c.place.y : c.place.x +
      tiles.x * (c.place.y + tiles.y * c.place.z);
  return true;
}
