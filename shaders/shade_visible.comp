#version 460
// Shades what the keys of a pixel's samples name: each triangle once, at the middle of the samples that it has there.
// SHARED, the number of samples: the pixels of a workgroup share the work on all triangles but their first, of which
// pixels at edges alone have some. So lanes do not wait for those of a neighbour.
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
#ifdef SHARED
const uint GROUP = 256u;
layout(local_size_x = 16, local_size_y = 16) in;
#else
layout(local_size_x = 8, local_size_y = 8) in;
#endif
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

#ifdef SHARED
shared uint more_count;
shared uint more_items[GROUP * (SHARED - 1)];  // number of the pixel in its group; samples, from bit 8 on
#ifdef WHOLE
shared vec4 more_radiance[GROUP * (SHARED - 1)];
#endif

// 8 by 4 pixels to each 32 of the 16 by 16 of a group.
uvec2 pixel_of(uint number) {
  return gl_WorkGroupID.xy * 16u +
      uvec2((number & 7u) | (number >> 2 & 8u), (number >> 3 & 3u) | (number >> 4 & 12u));
}

void main() {
  const uint mine = gl_LocalInvocationIndex;
  const uvec2 pixel = pixel_of(mine);
  const bool inside = all(lessThan(pixel, frame.size_px));
  const uint all_samples = (1u << SAMPLES) - 1u;
  if (mine == 0u) more_count = 0u;
  barrier();
  uint seen = 0u, first_covered = 0u, first_triangle = 0u, first_more = 0u, more = 0u;
  vec2 first_place;
  if (inside) {
    pixel_middle = vec2(pixel) + 0.5;
    begin_keyed(pixel);
    seen = keyed_left;
    if (seen != 0u) first_triangle = take_triangle(first_covered, first_place);
    uint own_items[SHARED - 1];
    for (; keyed_left != 0u; ++more) {
      uint covered;
      vec2 place;
      take_triangle(covered, place);
      own_items[more] = mine | covered << 8;
    }
    if (more != 0u) first_more = atomicAdd(more_count, more);
    for (uint i = 0u; i < more; ++i) more_items[first_more + i] = own_items[i];
  }
  barrier();
#ifdef WHOLE
  vec4 sum = vec4(0.0);
#endif
  if (inside && seen != all_samples) {
    const vec4 behind = behind_all(pixel_middle);
#ifdef WHOLE
    sum = behind * (float(SAMPLES - bitCount(seen)) / float(SAMPLES));
#else
    store_samples(ivec2(pixel), all_samples & ~seen, behind);
#endif
  }
  // The pixel's own first triangle, and then what there is more of in the group.
  const uint all_items = GROUP + more_count;
  for (uint i = mine; i < all_items; i += GROUP) {
    const bool is_first = i < GROUP;
    uint covered = first_covered, triangle = first_triangle;
    vec2 place = first_place;
    uvec2 at = pixel;
    if (!is_first) {
      const uint item = more_items[i - GROUP];
      at = pixel_of(item & 0xffu);
      begin_keyed(at);
      keyed_left = item >> 8;
      triangle = take_triangle(covered, place);
    }
    if (covered == 0u) continue;
    pixel_middle = vec2(at) + 0.5;
    const vec4 radiance = shade_triangle(triangle, place, at, covered);
#ifdef WHOLE
    const vec4 part = radiance * (float(bitCount(covered)) / float(SAMPLES));
    if (is_first)
      sum += part;
    else
      more_radiance[i - GROUP] = part;
#else
    store_samples(ivec2(at), covered, radiance);
#endif
  }
#ifdef WHOLE
  barrier();
  for (uint i = 0u; i < more; ++i) sum += more_radiance[first_more + i];
  if (inside) imageStore(storage_images[pc.own], ivec2(pixel), sum);
#endif
}
#else
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
#endif
