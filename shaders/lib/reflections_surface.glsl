#pragma once
// What reflections need to know of an opaque or masked surface (lib/reflections.glsl), and the light of the fog before
// it. Needs lib/surface.glsl, lib/brdf.glsl, lib/ambient.glsl, lib/occlusion.glsl and, with FOG, lib/fog.glsl.
#include "lib/reflections.glsl"

struct ReflectingTexel {
  uvec4 surface;
  uvec2 reflectance;
  vec4 sky;
#ifdef FOG
  vec4 fog;
#endif
};

// plane_normal: the triangle's, on the viewer's side. rounded_normal, rounded_point: openness is asked about these, as
// lib/rounded.glsl has them.
ReflectingTexel reflecting_texel(Surface s, bool is_unlit, vec3 position, vec3 plane_normal, vec3 rounded_point,
                                 vec3 rounded_normal, vec3 to_viewer) {
  Reflecting r;
  r.normal = to_camera_space(is_unlit ? plane_normal : s.normal);
  r.plane = to_camera_space(plane_normal);
  vec3 fraction = vec3(0.0), sky = vec3(0.0);
  float roughness = s.roughness;
  float open = 1.0;
  r.f0 = vec3(0.0);
  r.f90 = 0.0;
  vec3 through = vec3(1.0);
  ReflectingTexel texel;
#ifdef FOG
  const FogSeen fog = fog_before(position);
  through = fog.through;
  texel.fog = vec4(fog.light, 1.0);
#endif
  if (!is_unlit) {
    const BrdfTerms brdf = brdf_terms(s, to_viewer);
#ifdef LOBED
    // The base alone reflects the scene, as far as the layers on it let its light through; coat and sheen reflect the
    // sky and the probes.
    const BrdfTerms filmed = under_film(brdf, IBL_METHOD != 0);
    const Surface base = with_round_facets(s);
    const float under = (1.0 - brdf.lobes.coat_takes) * (1.0 - brdf.lobes.sheen_takes);
    r.f0 = filmed.f0 / brdf.lobes.gain;
    r.f90 = largest(filmed.f90 / brdf.lobes.gain);
    const vec3 albedo = specular_albedo(base, clamp(dot(s.normal, to_viewer), 1e-4, 1.0));
    fraction = (filmed.f0 * albedo.x + filmed.f90 * albedo.y) * (s.occlusion * under) * through;
#else
    const Surface base = s;
    r.f0 = mix(s.dielectric_f0, s.base_color, s.metallic);
    r.f90 = s.has_facets ? mix(s.dielectric_f90, 1.0, s.metallic) : max(r.f0.r, max(r.f0.g, r.f0.b));
    // What the material says of its own hollows hides the scene as it hides the sky.
    const vec3 albedo = specular_albedo(s, clamp(dot(s.normal, to_viewer), 1e-4, 1.0));
    fraction = (brdf.f0 * albedo.x + brdf.f90 * albedo.y) * s.occlusion * through;
#endif
    roughness = base.roughness;
    if (HAS_AMBIENT != 0) {
      shade_probes(s, brdf, position);
      float lights_open = 1.0;
      if (HAS_OCCLUSION != 0) {
        if (HAS_OCCLUSION < 0) begin_rays(rounded_point, rounded_normal);
        const Openness o = occlusion_open(rounded_point, rounded_normal, base, to_viewer);
        know_openness(o, rounded_normal);
        open = reflected_open(o, base, to_viewer, rounded_normal);
        lights_open = reflected_lights_open(o, open);
      }
#ifdef LOBED
      const AmbientLobes of_sky = base_of_sky(s, brdf, s.normal);
      const float covered = under * s.occlusion * frame.pre_exposure;
#else
      const AmbientLobes of_sky = ambient_lobes(s, brdf, s.normal);
      const float covered = s.occlusion * frame.pre_exposure;
#endif
      sky = of_sky.specular * covered * through;
      vec3 lights = of_sky.lights * covered * through;
#ifdef FOG
      const vec3 through_fog = fog_sky_through_surface(position, s.normal);
      sky *= through_fog;
      lights *= through_fog;
#endif
      if (PROBE_COUNT != 0 || lights != vec3(0.0)) {
        // Near surfaces leave all of the probes' light. What is drawn of the sum is `sky` times `open`.
#ifdef LOBED
        const vec3 of_probes = PROBE_COUNT != 0 ? probes.base : vec3(0.0);
#else
        const vec3 of_probes = PROBE_COUNT != 0 ? probes.specular : vec3(0.0);
#endif
        const vec3 local = of_probes * (s.occlusion * frame.pre_exposure) * through;
        const vec3 drawn = sky * open + lights * lights_open + local;
        const float whole = dot(sky + lights + local, vec3(1.0)), part = dot(drawn, vec3(1.0));
        if (whole > 0.0 && part > 0.0) {
          open = min(part / whole, 1.0);
          sky = drawn / open;
        }
      }
    }
  }
  texel.surface = pack_reflecting(r);
  texel.reflectance = pack_reflectance(fraction, roughness);
  texel.sky = vec4(sky, open);
  return texel;
}
