// Light that rays find open: the exact end of shadows and of ambient occlusion. Needs lib/scene.glsl, the push
// constants of DrawPush, lib/light_data.glsl, and a fragment shader that calls begin_rays first. Only where TRACES is
// defined, which pipelines that send rays do (passes/shared/draw_batches.cpp): else nothing of it is compiled.
// With LIGHT_EVAL lib/light_eval.glsl too.
//
// A fragment's rays begin where a ray of the camera through it meets the trees: on the triangle itself and off it by
// the bound of its roundings, as the reference's do (src/reference/accel.cpp), so that no surface darkens itself and no
// shadow comes off what casts it. An interpolated position knows its surface only to a fraction of the triangle's size.
// With LIGHT_RECORDS the rays to lights have been sent before (passes/shadows/light_rays.h).
#include "lib/openness.glsl"
#include "shared/trace.h"
#ifndef TRACES
Openness traced_open() { return Openness(1.0, 1.0, -1.0, -1.0, -1.0, vec3(0.0)); }
float traced_lobe(vec3 normal, vec3 to_viewer, float roughness, float f0) { return 1.0; }
#endif
#if !defined(TRACES) && !defined(LIGHT_RECORDS)
void begin_rays(vec3 position, vec3 normal) {}
float traced_visibility(LightRef light, uint number) { return 1.0; }
#ifdef LIGHT_EVAL
vec3 traced_soft_light(LightRef light, uint number, BrdfTerms brdf, vec3 position) { return vec3(0.0); }
#endif
#else
#ifdef TRACES
#include "lib/rays.glsl"
#endif
#include "lib/light_cap.glsl"
#ifdef LIGHT_RECORDS
#define RECORDS_AT pc.rays
#include "lib/light_records.glsl"
#endif

#ifdef TRACES
#ifdef VOXELS
#include "lib/light_voxels.glsl"
// What the fragment's cell knows (passes/shadows/light_voxels.h). Where that is all the light there is, no ray is sent,
// not even the one that finds where rays begin.
uint voxel;         // its cell
uint voxel_word;    // which word of the states is loaded
uint voxel_states;
vec3 voxel_normal;  // of the triangle, on the viewer's side
bool rays_wait;     // nothing has been sent yet
float rays_known;   // share of a light that its rays would find, below 0: they are to be sent

void begin_rays(vec3 position, vec3 normal) {
  voxel = find_voxel(pc.rays, VoxelGridRef(pc.rays).g, position, voxel_side(normal));
  voxel_word = no_voxel;
  voxel_normal = normal;
  rays_from = trace_free_point(position, normal, 0.0);
  rays_side = normal;
  rays_known = -1.0;
  rays_wait = true;
#ifdef SCATTERS
  find_origin(position, normal);
  rays_wait = false;
#endif
}
void send_rays() {
  if (!rays_wait) return;
  rays_wait = false;
  find_origin(rays_from.position, rays_from.normal);
}
// The fraction of a light that arrives, as far as the cell knows; below 0: rays must tell.
float known_visibility(LightRef light, uint number) {
  const vec2 z_type = light_word(light, 3u);
  const bool is_sun = floatBitsToUint(z_type.y) == light_directional;
  if ((LIGHT_VOXELS & (is_sun ? voxels_of_suns : voxels_of_lamps)) == 0 || voxel == no_voxel) return -1.0;
  const VoxelGrid grid = VoxelGridRef(pc.rays).g;
  if (voxel_word != number / voxel_lights_a_word) {
    voxel_word = number / voxel_lights_a_word;
    voxel_states = VoxelWordRef(voxel_word_at(voxel_states_at(pc.rays, grid.tiles, grid.capacity), grid.words, 
        min(voxel, grid.capacity - 1u), min(voxel_word, grid.words - 1u))).u;
  }
  const uint state = voxel_states >> 2u * (number % voxel_lights_a_word) & 3u;
  if (state == voxel_dark) return 0.0;
  if (state == voxel_unknown || (state == voxel_both && (LIGHT_VOXELS & voxels_halve) == 0)) return -1.0;
  const vec3 l = is_sun ? -vec3(light_word(light, 2u), z_type.x)
      : vec3(light_word(light, 0u), light_word(light, 1u).x) - rays_from.position;
  return !(dot(voxel_normal, l) > 0.0) ? -1.0 : state == voxel_lit ? 1.0 : 0.5;
}
#else
void begin_rays(vec3 position, vec3 normal) { find_origin(position, normal); }
void send_rays() {}
#endif

// The same of what a ray has met.
void begin_rays_at(TraceHit hit, vec3 to_viewer) {
  rays_from = trace_point(hit);
  if (rays_from.normal == vec3(0.0)) rays_from.normal = to_viewer;
  rays_side = dot(rays_from.normal, to_viewer) < 0.0 ? -rays_from.normal : rays_from.normal;
}

// The ray towards number i of the places on the light. l: its direction.
TraceRay ray_to_light(LightCap cap, uint i, uvec2 own, out vec3 l) {
  const float distance_m = place_on_light(cap, i, own, l);
  TraceRay ray;
  ray.t_min = 0.0;
  ray.origin = leaving_origin(rays_from, l);
  ray.direction = l;
  ray.t_max = TRACE_FAR;
  if (distance_m < light_at_infinity) {
    ray.direction = rays_from.position + l * distance_m - ray.origin;
    ray.t_max = BEFORE_END;
  }
  return ray;
}
float ray_seen(TraceRay ray, vec3 l, bool is_lamp) {
  // The surface itself keeps off light from behind it, which a shading normal may let in.
#ifdef LOBED
  const bool through = HAS_PASSING && lit_plane != vec3(0.0);  // light_along() has asked
#else
  const bool through = false;
#endif
  if (!through && !(dot(rays_side, l) > 0.0)) return 0.0;
#ifdef VOXELS
  if (rays_known >= 0.0) return rays_known;
#endif
  if (!(dot(ray.direction, l) > 0.0)) return 1.0;  // closer than what keeps it off the surface
  return rays_through(ray, is_lamp ? TRACE_TO_LAMP : 0u, 0.0, 0.0);
}
#else
void begin_rays(vec3 position, vec3 normal) {}
#endif

// 1: lit, 0: in shadow; of lights with a size the part of the directions to it that are open. number: the light's.
float traced_visibility(LightRef light, uint number) {
#ifdef LIGHT_RECORDS
  return find_record(number) ? record_seen(0u) : 0.0;
#else
#ifdef VOXELS
  rays_known = known_visibility(light, number);
  if (rays_known >= 0.0) return rays_known;
#endif
  send_rays();
  const LightCap cap = light_cap(light, rays_from.position);
  const uint count = light_samples(cap);
  const uvec2 own = rays_own(1u + number);
  float seen = 0.0;
  for (uint i = 0u; i < count; ++i) {
    vec3 l;
    const TraceRay ray = ray_to_light(cap, rays_first(count) + i, own, l);
    seen += ray_seen(ray, l, cap.centre_m < TRACE_FAR);
  }
  return seen / float(count);
#endif
}

#ifdef LIGHT_EVAL
// A light with a size: the mean over its directions of what each gives. Its intensity is that of the punctual light in
// its middle, whose window of the range, cone and inverse square it has.
vec3 traced_soft_light(LightRef light, uint number, BrdfTerms brdf, vec3 position) {
  vec3 to_middle;
  float arriving = light_arriving(light, position, to_middle);
  if (arriving == 0.0) return vec3(0.0);
#ifdef LIGHT_RECORDS
  if (!find_record(number)) return vec3(0.0);
#else
#ifdef VOXELS
  rays_known = known_visibility(light, number);
  if (rays_known == 0.0) return vec3(0.0);
  if (rays_known < 0.0)
#endif
    send_rays();
#endif
  const LightCap cap = light_cap(light, position);
  if (cap.centre_m < cap.radius_m) {
    const float radius2 = cap.radius_m * cap.radius_m;
    arriving *= min(max(cap.centre_m * cap.centre_m, frame.least_light_distance2), radius2) / radius2;
  }
  // Over a cap the mean cosine to its middle is 1 - height / 2; from all sides a surface gets a quarter of what comes.
  arriving *= cap.height == 2.0 ? 4.0 : 1.0 / (1.0 - 0.5 * cap.height);
  const uint count = light_samples(cap);
  const uvec2 own = rays_own(1u + number);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < count; ++i) {
    vec3 l;
#ifdef LIGHT_RECORDS
    place_on_light(cap, rays_first(count) + i, own, l);
    const vec3 offered = light_along(light, brdf, l, arriving);
    if (offered != vec3(0.0)) sum += offered * record_seen(i);
#else
    const TraceRay ray = ray_to_light(cap, rays_first(count) + i, own, l);
    const vec3 offered = light_along(light, brdf, l, arriving);
    if (offered != vec3(0.0)) sum += offered * ray_seen(ray, l, cap.centre_m < TRACE_FAR);
#endif
  }
  return sum / float(count);
}
#endif

#ifdef TRACES
// As sky_open, of the point that begin_rays was called for.
Openness traced_open() {
  send_rays();
  return openness(sky_open(OCCLUSION_IS_BENT));
}
float traced_lobe(vec3 normal, vec3 to_viewer, float roughness, float f0) {
  send_rays();
  return lobe_open(normal, to_viewer, roughness, f0);
}
#endif
#endif
