#pragma once
// What both steps of rasterization share (passes/geometry/rasterize.h). HAS_MASKS: some triangles have holes.
#define TRIANGLES
#include "shared/visibility.h"
#include "shared/cull.h"
#extension GL_EXT_shader_atomic_int64 : require
layout(push_constant, scalar) uniform Push { RasterizePush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/rasterize.glsl"
#include "lib/sample_places.glsl"
layout(constant_id = 30) const int SAMPLES = 1;
layout(constant_id = 31) const int HAS_MASKS = 0;
layout(constant_id = 32) const int MASKS_BY_SAMPLE = 0;
const uint all_samples = (1u << SAMPLES) - 1u;

ivec2 sample_place(int s) { return ivec2(sample_place_px(SAMPLES, uint(s)) * float(raster_one)); }

// The triangle that this thread works on.
struct Triangle {
  uint number;  // among all of the frame
  TriangleBatch batch;
  Item item;
  Geometry geometry;
  Corners corners;
  vec4 a, b, c;  // in clip space
};
Triangle load_triangle(TriangleBatch batch, Item item, uint number) {
  Triangle t;
  t.number = number;
  t.batch = batch;
  t.item = item;
  t.geometry = load_geometry(item.geometry);
  t.corners = load_corners(pc.indices, item, t.geometry, batch.first_triangle + number % triangle_batch_size);
  t.a = clip_position(t.corners.p[0]);
  t.b = clip_position(t.corners.p[1]);
  t.c = clip_position(t.corners.p[2]);
  return t;
}

bool is_culled(TriangleBatch batch, Piece piece) {
  const bool front = piece.clockwise == ((batch.flags & batch_mirrored) != 0u);
  return (batch.flags & batch_cull_back) != 0u && !front;
}

bool in_hole(Triangle t, vec2 place) {
  const TrianglePoint p = meet_triangle(t.corners, view_ray(place));
  const Material m = load_material(t.item.material);
  Varyings v = no_varyings();
  put_base_varyings(t.geometry, t.corners, p, v);
  return surface_base_color(m, v).a < m.alpha_cutoff;
}
// Without the samples that lie in the mask's holes; by the pixel's own place, or each by its own.
uint without_holes(Triangle t, ivec2 pixel, uint covered) {
  vec2 place = vec2(0.0);
  uint kept = covered;
  for (int s = 0; s < SAMPLES; ++s) {
    if ((covered >> s & 1u) == 0u) continue;
    const vec2 own = sample_place_px(SAMPLES, uint(s));
    place += own;
    if (MASKS_BY_SAMPLE != 0 && in_hole(t, vec2(pixel) + own)) kept &= ~(1u << s);
  }
  if (MASKS_BY_SAMPLE != 0) return kept;
  place = covered == all_samples ? vec2(0.5) : place / float(bitCount(covered));
  return in_hole(t, vec2(pixel) + place) ? 0u : covered;
}

void put_pixel(Triangle t, Piece piece, ivec2 pixel, uint covered) {
  if (covered == 0u) return;
  if (HAS_MASKS != 0 && (t.batch.flags & batch_masked) != 0u) covered = without_holes(t, pixel, covered);
  KeysRef keys = KeysRef(pc.keys);
  const uint first = (uint(pixel.y) * frame.size_px.x + uint(pixel.x)) * uint(SAMPLES);
  for (int s = 0; s < SAMPLES; ++s) {
    if ((covered >> s & 1u) == 0u) continue;
    const uint64_t key =
        uint64_t(piece_depth(piece, (pixel << 8) + sample_place(s))) << 32 | uint64_t(t.number + 1u);
    if (keys.k[first + uint(s)] < key) atomicMax(keys.k[first + uint(s)], key);
  }
}
void put_pixel_by_edges(Triangle t, Piece piece, Edges e, ivec2 corner, ivec2 pixel) {
  uint covered = 0u;
  for (int s = 0; s < SAMPLES; ++s) {
    const i64vec2 p = i64vec2((pixel << 8) + sample_place(s) - corner);
    if (all(greaterThan(i64vec3(e.a) * p.x + i64vec3(e.b) * p.y + e.c, i64vec3(0)))) covered |= 1u << s;
  }
  put_pixel(t, piece, pixel, covered);
}
