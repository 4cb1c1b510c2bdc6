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
  const KeyedPoint k = keyed_point(triangle, place, pixel, covered);
#ifdef RELIEFS
  end_relief_light();
  if (k.on_relief) begin_relief_light(k.relief.layer, k.relief.at, k.relief.lod, k.relief.back);
#endif
  const Varyings v = keyed_varyings(k);
#ifdef FOG
  const FogSeen fog = fog_before(k.at.position);
#endif
  vec3 radiance;
  if ((k.batch.flags & batch_unlit) != 0u) {
    radiance = max(surface_base_color(k.material, v).rgb, vec3(0.0));
  } else {
    const vec3 to_viewer = keyed_direction_to_viewer();
    const Surface s = load_surface(k.material, v, is_front(k) ? 1.0 : -1.0, to_viewer);
    vec3 plane_normal = vec3(0.0);
    if (HAS_SHADOWS || HAS_OCCLUSION != 0) plane_normal = keyed_plane_normal(k, to_viewer);
    vec3 surface_point = k.at.position;
    round_off(k.item, k.geometry, k.corners, k.at, plane_normal, surface_point);
    begin_rays(surface_point, plane_normal);
    radiance = surface_radiance(s, brdf_terms(s, to_viewer), k.at.position, surface_point, plane_normal);
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
    const vec4 radiance = shade_triangle(triangle, place, pixel, covered);
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
