#pragma once
// What both steps of rasterization share (passes/geometry/rasterize.h). HAS_MASKS: some triangles have holes. VIEWS: of
// a table of views, depth alone, from both sides; else the camera's keys.
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
#if defined(RELIEFS) && defined(VIEWS)
#include "lib/relief_view.glsl"
#endif
layout(constant_id = 30) const int SAMPLES = 1;
layout(constant_id = 31) const int HAS_MASKS = 0;
layout(constant_id = 32) const int MASKS_BY_SAMPLE = 0;
const uint all_samples = (1u << SAMPLES) - 1u;

#ifdef VIEWS
View raster_view;  // that this thread draws
void begin_view(uint view) {
  raster_view = ViewsRef(pc.views).v[view];
  raster_size_px = raster_view.size_px;
  raster_first_px = ivec2(0);
  raster_end_px = ivec2(raster_size_px);
}
#ifdef LAMPS
vec4 raster_position(vec3 about_light) { return lamp_clip(raster_view.clip_from_relative, about_light); }
#else
vec4 raster_position(vec3 relative) {
  vec4 clip = raster_view.clip_from_relative * vec4(relative, 1.0);
  // What lies before the near plane is flattened onto it, but in perspective: depth_view.vert.
  if ((raster_view.flags & view_is_perspective) == 0u) clip.z = min(clip.z, clip.w);
  return clip;
}
#endif
#else
void begin_view(uint view) {
  raster_size_px = frame.size_px;
  raster_first_px = ivec2(pc.part_first);
  raster_end_px = ivec2(pc.part_end);
}
vec4 raster_position(vec3 relative) { return clip_position(relative); }
#endif

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
#ifdef LAMPS
  for (int i = 0; i < 3; ++i)
    t.corners.p[i] = position_about(raster_view.origin, raster_view.origin_rest, item, t.geometry, t.corners.v[i]);
#endif
  t.a = raster_position(t.corners.p[0]);
  t.b = raster_position(t.corners.p[1]);
  t.c = raster_position(t.corners.p[2]);
  return t;
}

layout(constant_id = 33) const int OPEN_SIDES = 0;  // of views of lights: light passes single-sided faces from behind
bool is_culled(TriangleBatch batch, Piece piece) {
#ifdef VIEWS
  if (OPEN_SIDES == 0) return false;
#endif
  const bool front = piece.clockwise == ((batch.flags & batch_mirrored) != 0u);
  return (batch.flags & batch_cull_back) != 0u && !front;
}

#ifdef VIEWS
// Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997.
vec3 weights_at(Triangle t, vec2 ndc) {
  const vec3 p = vec3(ndc, 1.0);
  const vec3 w =
      vec3(dot(cross(t.b.xyw, t.c.xyw), p), dot(cross(t.c.xyw, t.a.xyw), p), dot(cross(t.a.xyw, t.b.xyw), p));
  const float sum = w.x + w.y + w.z;
  return sum != 0.0 ? w / sum : vec3(1.0 / 3.0);
}
TrianglePoint point_at(Triangle t, vec2 place) {
  const vec2 px = 2.0 / vec2(raster_size_px), ndc = place * px - 1.0;
  TrianglePoint p;
  p.position = p.plane = vec3(0.0);
  p.weights = weights_at(t, ndc);
  p.across = weights_at(t, ndc + vec2(px.x, 0.0)) - p.weights;
  p.down = weights_at(t, ndc + vec2(0.0, px.y)) - p.weights;
  return p;
}
#else
TrianglePoint point_at(Triangle t, vec2 place) { return meet_triangle(t.corners, view_ray(place)); }
#endif

bool in_hole(Triangle t, vec2 place) {
  const TrianglePoint p = point_at(t, place);
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

void put_sample_at(uint depth, uint number, ivec2 pixel, int sample_number) {
#ifdef VIEWS
  const uvec2 texel = raster_view.origin_px + uvec2(pixel);
  const uint at = (raster_view.layer * pc.image_px + texel.y) * pc.image_px + texel.x;
  atomicMax(DepthsRef(pc.keys).d[at], depth);
#else
  const uint at = (uint(pixel.y) * frame.size_px.x + uint(pixel.x)) * uint(SAMPLES) + uint(sample_number);
  const uint64_t key = uint64_t(depth) << 32 | uint64_t(number + 1u);
  atomicMax(KeysRef(pc.keys).k[at], key);
#endif
}
void put_sample(Piece piece, uint number, ivec2 pixel, int sample_number) {
  put_sample_at(piece_depth(piece, (pixel << 8) + sample_place(sample_number)), number, pixel, sample_number);
}
#ifdef RELIEFS
// Of the relief below a place of the triangle; false: what is seen there passes it by.
bool relief_clip(Triangle t, vec2 place, out vec4 clip) {
  const Material m = load_material(t.item.material);
  TrianglePoint p = point_at(t, place);
#ifdef VIEWS
  const Relief r = triangle_relief(t.item, t.geometry, t.corners.v, t.corners.p, m);
  const vec3 entry = t.corners.p[0] + p.weights.y * r.e1 + p.weights.z * r.e2;
#ifdef LAMPS
  const vec3 direction = entry;
#else
  const vec3 direction = relief_view_direction(raster_view.clip_from_relative, entry);
#endif
  if (!meet_relief_view(r, entry, direction, p.position)) return false;
#else
  if (!meet_relief_depth(t.item, t.geometry, t.corners, m, view_ray(place), p)) return false;
#endif
  clip = raster_position(p.position);
  return true;
}
void put_relief(Triangle t, ivec2 pixel, uint covered) {
#ifndef VIEWS
  if (RELIEF_OF_SAMPLES) {
    for (int s = 0; s < SAMPLES; ++s) {
      vec4 clip;
      if ((covered >> s & 1u) != 0u && relief_clip(t, vec2(pixel) + sample_place_px(SAMPLES, uint(s)), clip))
        put_sample_at(floatBitsToUint(clamp(clip.z / clip.w, 1e-37, 1.0)), t.number, pixel, s);
    }
    return;
  }
#endif
  vec2 place = vec2(0.5);
  if (covered != all_samples) {
    place = vec2(0.0);
    for (int s = 0; s < SAMPLES; ++s)
      if ((covered >> s & 1u) != 0u) place += sample_place_px(SAMPLES, uint(s));
    place /= float(bitCount(covered));
  }
  vec4 clip;
  if (!relief_clip(t, vec2(pixel) + place, clip)) return;
  const uint depth = floatBitsToUint(clamp(clip.z / clip.w, 1e-37, 1.0));
  for (int s = 0; s < SAMPLES; ++s)
    if ((covered >> s & 1u) != 0u) put_sample_at(depth, t.number, pixel, s);
}
#endif
void put_pixel(Triangle t, Piece piece, ivec2 pixel, uint covered) {
  if (covered == 0u) return;
#ifdef RELIEFS
  if ((t.batch.flags & batch_relief) != 0u) {
    put_relief(t, pixel, covered);
    return;
  }
#endif
  if (HAS_MASKS != 0 && (t.batch.flags & batch_masked) != 0u) covered = without_holes(t, pixel, covered);
  for (int s = 0; s < SAMPLES; ++s)
    if ((covered >> s & 1u) != 0u) put_sample(piece, t.number, pixel, s);
}
