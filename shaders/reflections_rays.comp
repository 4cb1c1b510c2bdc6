#version 460
// Rays about the mirror direction, through the trees of the frame's triangles: what they meet sends the light that the
// functions of all techniques give it. Where the camera sees the surface is where its own ray meets the trees
// (begin_rays), so that no surface reflects itself.
#define TRIANGLES
#define FACETS_DISC
#ifndef TRACES  // as frames say that send rays
#define TRACES
#endif
#include "shared/draw.h"
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"
#include "lib/shade.glsl"
#include "lib/shade_hit.glsl"
#include "lib/reflections.glsl"
#include "lib/ambient_sh.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 30) const int SIDE = 1;  // of a texel, in pixels
layout(constant_id = 31) const int HAS_SKY = 0;
#include "lib/reflections_lobe.glsl"

uint place_of(uint n) { return uint(pc.table >> (8u * n)) & 0xffu; }  // REFLECTIONS_IMAGES

// Along the ray, as far as it meets an opaque or masked surface: blended ones are not there for reflections.
bool meet_scene(TraceRay ray, out TraceHit hit) {
  TraceHit passed = TRACE_NOTHING;
  uint mode = 0u;
  const TraceScene s = TraceSceneRef(TRACE_ADDRESS).s;
  while (trace(ray, mode, passed, hit)) {
    if (RAYS_MEET_BLENDED == 0 || (trace_item(s, hit.item).flags & trace_blended) == 0u) return true;
    passed = hit;
    ray.t_min = hit.t;
    mode = TRACE_PASSED;
  }
  return false;
}

void main() {
  const uvec2 texel = gl_GlobalInvocationID.xy;
  const ivec2 texels = imageSize(storage_images[place_of(3u)]);
  if (any(greaterThanEqual(ivec2(texel), texels))) return;
  const ivec2 pixel = min(ivec2(texel) * SIDE, ivec2(frame.size_px) - 1);
  pixel_middle = vec2(pixel) + 0.5;
  const float depth = texelFetch(pass_images[place_of(0u)], pixel, 0).r;
  const vec4 reflectance = unpack_reflectance(texelFetch(pass_uint_images[place_of(2u)], pixel, 0).xy);
  const float wanted = reflects_scene(reflectance.a, uintBitsToFloat(pc.own));
  vec4 light = vec4(0.0);
  TraceHit hit = TRACE_NOTHING;  // valid in all lanes (lib/trace.glsl)
  if (depth > 0.0 && reflectance.rgb != vec3(0.0) && wanted > 0.0) {
    const Reflecting r = unpack_reflecting(texelFetch(pass_uint_images[place_of(1u)], pixel, 0));
    const vec3 p = occlusion_position(pixel_middle, metres_of(depth), pc.subsample_ndc);
    const bool perspective = frame.perspective != 0u;
    const ReflectedLobe lobe = reflected_lobe(r, perspective ? normalize(-p) : vec3(0.0, 0.0, 1.0), reflectance.a);
    const uint samples = uint(pc.table >> 32) & 0xfffu, pictures = uint(pc.table >> 44) & 0xffffu;
    const uint moved = uint(pc.table >> 60);
    const uint order = pattern_of(texel + uvec2(moved & 3u, moved >> 2));
    const float pixel_m = (perspective ? length(p) : 1.0) * 2.0 * frame.tan_half.y / float(frame.size_px.y);
    begin_rays(from_camera_space(p), from_camera_space(r.plane));
    const TracePoint from = rays_from;
    LobeLight sum = LobeLight(vec3(0.0), vec3(0.0), 0.0, 0.0);
    for (uint i = 0u; i < samples; ++i) {
      const uint part = i * pictures + pc.subsample;
      LobeSample sampled;
      if (!lobe_sample(lobe, part, samples * pictures, order, sampled)) continue;
      sum.all += sampled.weight;
      sum.sky_all += sampled.sky;
      if (dot(sampled.l, r.plane) <= 0.0) continue;  // into the surface: unknown
      const vec3 l = from_camera_space(sampled.l);
      const TraceRay ray = TraceRay(leaving_origin(from, l), 0.0, l, TRACE_FAR);
      if (!meet_scene(ray, hit)) continue;
      rays_part = i;
      rays_parts = samples;
      vec3 seen = hit_radiance(hit, ray, pixel_m, sampled.cone) * frame.pre_exposure;
#ifdef FOG
      seen *= fog_through(from.position, l, hit.t);
#endif
      sum.light += sampled.weight * seen * wanted;
      sum.sky_hit += sampled.sky * wanted;
    }
    light = mean_of(sum);
  }
  imageStore(storage_images[place_of(3u)], ivec2(texel), light);
}
