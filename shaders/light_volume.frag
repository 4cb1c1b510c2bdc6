#version 460
// Adds a light's part to the radiance of what the G-buffer holds, for one sample and all later ones of the pixel that
// hold the same bits. MARKED: the stencil test has left these alone. REACHED: surfaces that the light does not reach
// are left before the rest of them is read. BASE: what surfaces send without the lights. EXPOSED: times the
// pre-exposure.
#define TRIANGLES
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#ifdef RELIEF_TEXEL
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#endif
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/shade.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"
#include "lib/gbuffer_relief.glsl"
#ifndef BASE
layout(location = 0) in flat uint in_light;
#endif
layout(location = 0) out vec4 out_radiance;

void main() {
  pixel_middle = floor(gl_FragCoord.xy) + 0.5;
  const ivec2 at = ivec2(gl_FragCoord.xy);
  const int s = int(pc.own);
  GBufferSample g;
  int loaded = 0;
#if defined(REACHED) && !defined(BASE)
  loaded = texels_of_position;
  load_texels(g, at, s, 0, loaded);
  if (!is_seen(g)) discard;
  vec3 l;
  if (light_arriving(light_at(pc.lights, in_light), position_of(own_texels(g)), l) == 0.0) discard;
#endif
  load_texels(g, at, s, loaded, gbuffer_images);
#ifndef MARKED
  const int same = samples_first_held(g, at, s);
  if (same == 0) discard;
  gl_SampleMask[0] = same;
#endif
  const vec3 to_viewer = direction_to_viewer();
  const SurfacePoint p = surface_point_of(g, to_viewer);
#if defined(RELIEF_TEXEL) && !defined(BASE)
  begin_gbuffer_relief(g, p.on_triangle);
#endif
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
