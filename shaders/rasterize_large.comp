#version 460
// Rasterizes the listed triangles tile by tile, a workgroup a tile: the tiles of all are numbered through, and each
// workgroup takes every so manieth.
#include "lib/rasterize_batch.glsl"
layout(local_size_x = 64) in;

void main() {
  LargeRef large = LargeRef(pc.large);
  const uint64_t ends = large.ends;
  const uint listed = uint(ends >> large_tile_bits), count = min(listed, pc.most_large);
  const uint64_t tiles = listed > count ? large.t[count].first_tile : ends & large_tile_mask;
  for (uint64_t tile = gl_WorkGroupID.x; tile < tiles; tile += gl_NumWorkGroups.x) {
    uint low = 0u, high = count;  // the last one that begins at or before the tile
    while (high - low > 1u) {
      const uint middle = (low + high) / 2u;
      if (large.t[middle].first_tile <= tile)
        low = middle;
      else
        high = middle;
    }
    const LargeTriangle l = large.t[low];
    const TriangleBatch b = BatchesRef(pc.batches).b[l.triangle / triangle_batch_size];
    const Triangle t = load_triangle(b, load_item(b.item), l.triangle);
    Piece piece;
    if (l.piece == 0u)
      make_piece(t.a, t.b, t.c, piece);
    else
      clipped_piece(t.a, t.b, t.c, int(l.piece) - 1, piece);
    const PixelBounds at = piece_bounds(piece);
    const ivec2 first = at.low / int(raster_tile_px), row = at.high / int(raster_tile_px) - first + 1;
    const int place = int(tile - l.first_tile);
    const ivec2 corner_px = (first + ivec2(place % row.x, place / row.x)) * int(raster_tile_px);
    const ivec2 corner = corner_px << 8;
    const Edges e = piece_edges(piece, corner);
    const i64vec3 side = i64vec3(int(raster_tile_px) << 8);
    if (any(lessThanEqual(e.c + side * i64vec3(max(e.a, 0) + max(e.b, 0)), i64vec3(0)))) continue;
    for (uint i = gl_LocalInvocationIndex; i < raster_tile_px * raster_tile_px; i += gl_WorkGroupSize.x) {
      const ivec2 pixel = corner_px + ivec2(i % raster_tile_px, i / raster_tile_px);
      if (all(lessThanEqual(pixel, at.high)) && all(greaterThanEqual(pixel, at.low)))
        put_pixel_by_edges(t, piece, e, corner, pixel);
    }
  }
}
