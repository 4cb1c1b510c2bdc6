// Whether a light can touch a cell of its chunk. Needs TEST, TILED and MASK, the push constant tiles,
// lib/light_bounds.glsl, lib/light_chunk.glsl.
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
