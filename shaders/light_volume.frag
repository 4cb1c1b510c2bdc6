#version 460
// Adds a light's part to the radiance of what the G-buffer holds, for one sample and all later ones of the pixel that
// hold the same bits. BASE: what surfaces send without the lights. EXPOSED: times the pre-exposure.
#define TRIANGLES
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/shade.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"
#ifndef BASE
layout(location = 0) in flat uint in_light;
#endif
layout(location = 0) out vec4 out_radiance;

void main() {
  pixel_middle = floor(gl_FragCoord.xy) + 0.5;
  const ivec2 at = ivec2(gl_FragCoord.xy);
  const int s = int(pc.own);
  const GBufferSample g = load_gbuffer(at, s);
  if (!is_seen(g)) discard;
  for (int before = 0; before < s; ++before)
    if (gbuffer_holds(g, at, before)) discard;
  int same = 1 << s;
  for (int other = s + 1; other < SAMPLES; ++other)
    if (gbuffer_holds(g, at, other)) same |= 1 << other;
  gl_SampleMask[0] = same;
  const vec3 to_viewer = direction_to_viewer();
  const SurfacePoint p = surface_point_of(g, to_viewer);
#ifdef BASE
  vec3 radiance = p.surface.emission;
#else
  if (p.is_unlit) discard;
  vec3 radiance = vec3(0.0);
#endif
  if (!p.is_unlit) {
    begin_rays(p.on_triangle, p.plane_normal);
    const BrdfTerms brdf = brdf_terms(p.surface, to_viewer);
#ifdef BASE
    radiance = radiance_without_lights(p.surface, brdf, p.position, p.on_triangle, p.plane_normal);
#else
    radiance = radiance_of_light(in_light, brdf, p.position, p.on_triangle, p.plane_normal);
#endif
  }
#ifdef EXPOSED
  radiance *= frame.pre_exposure;
#endif
  out_radiance = vec4(radiance, 0.0);
}
