#pragma once
// The light that a surface sends to the viewer, before exposure: its emission, ambient light, and every light of the
// point's list, or all, in ascending order and summed without contraction, so that a culled list gives the same bits.
// Needs the push constants of DrawPush, lib/surface.glsl, and what it includes. begin_rays goes
// before.
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_shadow.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/ambient.glsl"
#include "lib/occlusion.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#include "lib/fog_lamps.glsl"
#endif

// What it sends without the lights: emission, and ambient light. surface_point, plane_normal: where its triangle is.
vec3 radiance_without_lights(Surface s, BrdfTerms brdf, vec3 position, vec3 surface_point, vec3 plane_normal) {
  precise vec3 radiance = s.emission;
  if (HAS_AMBIENT != 0) {
    shade_probes(s, brdf, position);
    vec3 ambient = HAS_OCCLUSION != 0
        ? occluded_ambient_light(s, brdf, occlusion_open(surface_point, plane_normal, s, brdf.to_viewer), plane_normal)
        : ambient_light(s, brdf);
#ifdef FOG
    ambient *= fog_sky_through_surface(position, s.normal);
#endif
    if (PROBE_COUNT != 0) ambient += probes.specular * s.occlusion;
    radiance += ambient;
  }
  return radiance;
}

// What it sends of one light.
vec3 radiance_of_light(uint number, BrdfTerms brdf, vec3 position, vec3 surface_point, vec3 plane_normal) {
  LightRef light = light_at(pc.lights, number);
  vec3 reaching = light_reaching(light, number, brdf, position, surface_point, plane_normal);
#ifdef FOG
  if (reaching != vec3(0.0)) reaching *= fog_light_through(light, position);
#endif
  return reaching;
}

vec3 surface_radiance(Surface s, BrdfTerms brdf, vec3 position, vec3 surface_point, vec3 plane_normal) {
  precise vec3 radiance = radiance_without_lights(s, brdf, position, surface_point, plane_normal);
  if (HAS_LIGHTS != 0)
    for (LightWalk w = begin_lights(position); next_light(w);)
      radiance += radiance_of_light(w.light, brdf, position, surface_point, plane_normal);
  return radiance;
}
