#version 460
// Rasterizes a batch of triangles, each thread one: those over few pixels at once, others go to a list for
// rasterize_large.comp. The key of a sample is the largest: the nearest depth, and of equal depths what is drawn last.
#include "lib/rasterize_batch.glsl"
layout(local_size_x = 64) in;

void rasterize_small(Triangle t, Piece piece, PixelBounds at) {
  const ivec2 corner = at.low << 8;
  const Edges e = piece_edges(piece, corner);
  const ivec3 c = ivec3(e.c);  // edges are short: all fits
  for (int y = at.low.y; y <= at.high.y; ++y)
    for (int x = at.low.x; x <= at.high.x; ++x) {
      uint covered = 0u;
      for (int s = 0; s < SAMPLES; ++s) {
        const ivec2 p = (ivec2(x, y) << 8) + sample_place(s) - corner;
        if (all(greaterThan(e.a * p.x + e.b * p.y + c, ivec3(0)))) covered |= 1u << s;
      }
      put_pixel(t, piece, ivec2(x, y), covered);
    }
}

uint large_listed() { return uint(LargeRef(pc.large).ends >> large_tile_bits); }

// False: the list is full. Its order is that of arrival, which no key depends on.
bool put_large(Triangle t, Piece piece, PixelBounds at) {
  LargeRef large = LargeRef(pc.large);
  if (large_listed() >= pc.most_large) return false;
  const ivec2 tiles = at.high / int(raster_tile_px) - at.low / int(raster_tile_px) + 1;
  const uint64_t before =
      atomicAdd(large.ends, (1ul << large_tile_bits) + uint64_t(tiles.x) * uint64_t(tiles.y));
  const uint place = uint(before >> large_tile_bits);
  // The first one beyond the end says where the last one's tiles end.
  if (place <= pc.most_large)
    large.t[place] = LargeTriangle(before & large_tile_mask, t.number, gl_WorkGroupID.z, piece.depth,
        uvec2[](uvec2(piece.p[0]), uvec2(piece.p[1]), uvec2(piece.p[2])));
  return place < pc.most_large;
}

void rasterize_alone(Triangle t, Piece piece, PixelBounds at) {
  for (int y = at.low.y; y <= at.high.y; ++y)
    for (int x = at.low.x; x <= at.high.x; ++x) {
      const Edges e = piece_edges(piece, ivec2(x, y) << 8);
      uint covered = 0u;
      for (int s = 0; s < SAMPLES; ++s) {
        const i64vec2 p = i64vec2(sample_place(s));
        if (all(greaterThan(i64vec3(e.a) * p.x + i64vec3(e.b) * p.y + e.c, i64vec3(0)))) covered |= 1u << s;
      }
      put_pixel(t, piece, ivec2(x, y), covered);
    }
}

bool stays(TriangleBatch b) {
  const uint bit = b.cull_bit + gl_WorkGroupID.z * pc.view_masks;
  return (MasksRef(pc.masks).m[bit / 32u] >> (bit & 31u) & 1u) != 0u;
}

void rasterize_batch(uint batch, TriangleBatch b) {
  const Item item = load_item(b.item);
  if (3u * (b.first_triangle + gl_LocalInvocationIndex) + 2u >= item.index_count) return;
  const Triangle t = load_triangle(b, item, batch * triangle_batch_size + gl_LocalInvocationIndex);
  if (outside_picture(t.a, t.b, t.c)) return;
  const bool clipped = needs_clipping(t.a, t.b, t.c);
  vec4 polygon[most_corners];
  int corners = 3;
  if (clipped) corners = clip_polygon(t.a, t.b, t.c, polygon);
  for (int i = 2; i < corners; ++i) {
    Piece piece;
    const bool has_area = clipped ? make_piece(polygon[0], polygon[i - 1], polygon[i], piece)
        : make_piece(t.a, t.b, t.c, piece);
    if (!has_area) continue;
    if (is_culled(b, piece)) return;
    const PixelBounds at = piece_bounds(piece);
    const ivec2 size = at.high - at.low + 1;
    if (any(lessThanEqual(size, ivec2(0)))) continue;
    const ivec2 extent = clipped ? ivec2(2 * raster_most_small_px) : piece_size(piece);
    const bool is_small = all(lessThanEqual(extent, ivec2(raster_most_small_px)));
    // What a thread can do alone leaves half of the list to what it cannot.
    if (all(lessThanEqual(extent, ivec2(pc.small_px))) || (is_small && large_listed() >= pc.most_large / 2u))
      rasterize_small(t, piece, at);
    else if (!put_large(t, piece, at))
      rasterize_alone(t, piece, at);
  }
}

#ifdef VIEWS
// Most batches are out of most views: a workgroup looks at several of them and goes through those that stay.
shared uint staying;

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint batches = gl_NumWorkGroups.z >= raster_many_views ? raster_view_batches : 1u;
  const uint first = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * batches;
  if (t == 0u) staying = 0u;
  barrier();
  if (t < batches && first + t < pc.batch_count && stays(BatchesRef(pc.batches).b[first + t]))
    atomicOr(staying, 1u << t);
  barrier();
  const uint all = staying;
  if (all == 0u) return;
  begin_view(gl_WorkGroupID.z);
  for (uint left = all; left != 0u; left &= left - 1u) {
    const uint batch = first + uint(findLSB(left));
    rasterize_batch(batch, BatchesRef(pc.batches).b[batch]);
  }
}
#else
void main() {
  const uint batch = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  if (batch >= pc.batch_count) return;
  const TriangleBatch b = BatchesRef(pc.batches).b[batch];
  if (!stays(b)) return;
  begin_view(0u);
  rasterize_batch(batch, b);
}
#endif
