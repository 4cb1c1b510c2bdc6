#version 460
// Rasterizes the listed triangles tile by tile. The tiles of all are numbered through, and a workgroup takes a chunk of
// them: each of its first threads finds out whose one tile is and whether anything of it is inside, then all threads
// share the pixels of those that are left.
#include "lib/rasterize_batch.glsl"
#include "lib/large_triangles.glsl"
layout(local_size_x = 64) in;

struct Tile {
  Piece piece;
  PixelBounds at;
  ivec2 corner_px;
  uint triangle, view;
};
shared Tile tiles[raster_chunk];
shared uint tile_count;

// False: nothing of the triangle is in the tile.
bool find_tile(uint64_t number, uint triangles, out Tile tile) {
  LargeRef large = LargeRef(pc.large);
  uint low = 0u, high = triangles;  // the last one that begins at or before the tile
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (large.t[middle].first_tile <= number)
      low = middle;
    else
      high = middle;
  }
  const LargeTriangle l = large.t[low];
  for (int i = 0; i < 3; ++i) tile.piece.p[i] = ivec2(l.p[i]);
  tile.piece.depth = l.depth;
  tile.piece.clockwise = true;
  tile.triangle = l.triangle;
  tile.view = l.view;
  begin_view(l.view);
  tile.at = piece_bounds(tile.piece);
  const ivec2 first = tile.at.low / int(raster_tile_px), row = tile.at.high / int(raster_tile_px) - first + 1;
  const int place = int(number - l.first_tile);
  tile.corner_px = (first + ivec2(place % row.x, place / row.x)) * int(raster_tile_px);
  const Edges e = piece_edges(tile.piece, tile.corner_px << 8);
  const i64vec3 side = i64vec3(int(raster_tile_px) << 8);
  return all(greaterThan(e.c + side * i64vec3(max(e.a, 0) + max(e.b, 0)), i64vec3(0)));
}

// Of a triangle's pixels something is asked that one sample does not know.
#ifdef RELIEFS
const bool ASKS_PIXELS = true;
#else
const bool ASKS_PIXELS = HAS_MASKS != 0;
#endif

void main() {
  const LargeCount large = large_count();
  const uint64_t first = (uint64_t(gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x) * raster_chunk;
  const uint thread = gl_LocalInvocationIndex;
  if (thread == 0u) tile_count = 0u;
  barrier();
  if (thread < raster_chunk && first + thread < large.tiles) {
    Tile tile;
    if (find_tile(first + thread, large.triangles, tile)) tiles[atomicAdd(tile_count, 1u)] = tile;
  }
  barrier();
  for (uint i = 0u; i < tile_count; ++i) {
    const Tile tile = tiles[i];
    begin_view(tile.view);
    Triangle t;
    t.number = tile.triangle;
    if (ASKS_PIXELS) {
      const TriangleBatch b = BatchesRef(pc.batches).b[tile.triangle / triangle_batch_size];
      t = load_triangle(b, load_item(b.item), tile.triangle);
    }
    const TileEdges e = tile_edges(tile.piece, tile.corner_px << 8);
    const uint side = raster_tile_px;
    if (ASKS_PIXELS) {
      for (uint j = thread; j < side * side; j += gl_WorkGroupSize.x) {
        const ivec2 inside = ivec2(j % side, j / side), pixel = tile.corner_px + inside;
        if (any(greaterThan(pixel, tile.at.high)) || any(lessThan(pixel, tile.at.low))) continue;
        uint covered = 0u;
        for (int s = 0; s < SAMPLES; ++s)
          if (inside_tile(e, (inside << 4) + (sample_place(s) >> 4))) covered |= 1u << s;
        put_pixel(t, tile.piece, pixel, covered);
      }
      continue;
    }
    // Neighbouring threads take the samples of a pixel, which lie side by side in memory.
    for (uint j = thread; j < side * side * uint(SAMPLES); j += gl_WorkGroupSize.x) {
      const int s = int(j % uint(SAMPLES));
      const uint place = j / uint(SAMPLES);
      const ivec2 inside = ivec2(place % side, place / side), pixel = tile.corner_px + inside;
      if (any(greaterThan(pixel, tile.at.high)) || any(lessThan(pixel, tile.at.low))) continue;
      if (inside_tile(e, (inside << 4) + (sample_place(s) >> 4))) put_sample(tile.piece, tile.triangle, pixel, s);
    }
  }
}
