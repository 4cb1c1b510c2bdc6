#version 460
// Shades what the keys of a pixel's samples name: each triangle once, at the middle of the samples that it has there.
#define TRIANGLES
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/shade.glsl"
#include "lib/sample_places.glsl"
#include "lib/sky_seen.glsl"
#ifdef WITHOUT_RECORDS
#define RECORDS_AT pc.rays
#include "lib/light_records.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 30) const int SAMPLES = 1;
#include "lib/keyed_triangles.glsl"
#ifndef WHOLE
#include "lib/store_samples.glsl"
#endif

// covered: the samples that have it.
vec4 shade_triangle(uint triangle, vec2 place, uvec2 pixel, uint covered) {
  const TriangleBatch batch = BatchesRef(frame.batches).b[triangle / triangle_batch_size];
  const Item item = load_item(batch.item);
  const Geometry g = load_geometry(item.geometry);
  const Corners corners =
      load_corners(frame.indices, item, g, batch.first_triangle + triangle % triangle_batch_size);
  const Material m = load_material(item.material);
#ifdef RELIEFS
  ViewRay ray;
  TrianglePoint p;
  ReliefPoint relief;
  const bool on_relief = meet_keyed_relief(batch.flags, item, g, corners, m, place, pixel, covered, ray, p, relief);
  Varyings v;
  end_relief_light();
  if (on_relief) {
    v = relief_varyings(item, g, corners, p, relief);
    begin_relief_light(relief.layer, relief.at, relief.lod, relief.back);
  } else {
    v = lit_varyings(item, g, corners, p);
  }
#else
  const ViewRay ray = view_ray(place);
  const TrianglePoint p = meet_triangle(corners, ray);
  const Varyings v = lit_varyings(item, g, corners, p);
#endif
#ifdef FOG
  const FogSeen fog = fog_before(p.position);
#endif
  vec3 radiance;
  if ((batch.flags & batch_unlit) != 0u) {
    radiance = max(surface_base_color(m, v).rgb, vec3(0.0));
  } else {
    const vec3 to_viewer =
        frame.perspective != 0u ? normalize(-view_ray(pixel_middle).direction) : frame.camera_back;
    const bool counter_clockwise = dot(p.plane, ray.direction) < 0.0;
    const bool is_front = counter_clockwise != ((batch.flags & batch_mirrored) != 0u);
    const Surface s = load_surface(m, v, is_front ? 1.0 : -1.0, to_viewer);
    vec3 plane_normal = vec3(0.0);
    if (HAS_SHADOWS || HAS_OCCLUSION != 0)
      plane_normal = normalize_or(counter_clockwise ? p.plane : -p.plane, to_viewer);
#ifdef RELIEFS
    if (on_relief) plane_normal = is_front ? relief.front : -relief.front;
#endif
    vec3 surface_point = p.position;
    round_off(item, g, corners, p, plane_normal, surface_point);
    begin_rays(surface_point, plane_normal);
    radiance = surface_radiance(s, brdf_terms(s, to_viewer), p.position, surface_point, plane_normal);
  }
#ifdef FOG
  return vec4(radiance * frame.pre_exposure * fog.through + fog.light, 1.0);
#else
  return vec4(radiance * frame.pre_exposure, 1.0);
#endif
}

vec4 behind_all(vec2 place) {
  const vec2 ndc = 2.0 * place / vec2(frame.size_px) - 1.0;
#ifdef FOG
  const FogSeen fog = fog_before_sky(IS_SUBSAMPLE != 0 ? ndc + pc.subsample_ndc : ndc);
#endif
#ifdef SKY
  const vec2 px = 2.0 / vec2(frame.size_px);
  const vec3 direction = sky_direction(ndc);
  float step = max(length(sky_direction(ndc + vec2(px.x, 0.0)) - direction),
      length(sky_direction(ndc + vec2(0.0, px.y)) - direction));
  if (IS_SUBSAMPLE != 0) step *= pc.subsample_footprint;
  const vec4 behind = vec4(sky_radiance(direction, step), 1.0);
#else
  const vec4 behind = frame.background;
#endif
#ifdef FOG
  return seen_through_fog(behind, fog);
#else
  return behind;
#endif
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  pixel_middle = vec2(pixel) + 0.5;
#ifdef LIGHT_RECORDS
  if (!begin_records(pixel)) return;  // shaded by the same without records, which sends rays itself
#endif
#ifdef WITHOUT_RECORDS
  if (record_place(pixel).w[0] != 0u) return;
#endif
  begin_keyed(pixel);
  const uint all_samples = (1u << SAMPLES) - 1u;
#ifdef WHOLE
  vec4 sum = vec4(0.0);
#endif
  if (keyed_left != all_samples) {
    const vec4 behind = behind_all(pixel_middle);
#ifdef WHOLE
    const int covered = SAMPLES - bitCount(keyed_left);
    sum = behind * (float(covered) / float(SAMPLES));
#else
    store_samples(ivec2(pixel), all_samples & ~keyed_left, behind);
#endif
  }
  while (keyed_left != 0u) {
    uint covered;
    vec2 place;
    const uint triangle = take_triangle(covered, place);
    const vec4 radiance = shade_triangle(triangle, vec2(pixel) + place, pixel, covered);
#ifdef LIGHT_RECORDS
    if (keyed_left != 0u) next_records();
#endif
#ifdef WHOLE
    sum += radiance * (float(bitCount(covered)) / float(SAMPLES));
#else
    store_samples(ivec2(pixel), covered, radiance);
#endif
  }
#ifdef WHOLE
  imageStore(storage_images[pc.own], ivec2(pixel), sum);
#endif
}
