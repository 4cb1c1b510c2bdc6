#version 460
// The terms whose sum shade_forward.frag and shade_unlit.frag put out, each into an attachment of its own and
// premultiplied as they do it, so that the same blending composites every term as it does the sum. With STORED the one
// term TERM of a blended surface is stored instead (passes/transparency/fragments.h).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_shadow.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/ambient.glsl"
#include "lib/occlusion.glsl"
#include "lib/draw.frag.glsl"
#include "lib/covered.glsl"
#include "lib/term_output.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#include "lib/fog_lamps.glsl"
#endif
#ifdef REFRACTION
#include "lib/refraction.glsl"
#endif

// Each wanted term is defined as its attachment's number; an unwanted one has no output.
#ifdef DIRECT_SUN
TERM_OUTPUT(DIRECT_SUN) vec4 out_direct_sun;
#endif
#ifdef DIRECT_POINT
TERM_OUTPUT(DIRECT_POINT) vec4 out_direct_point;
#endif
#ifdef DIRECT_SPOT
TERM_OUTPUT(DIRECT_SPOT) vec4 out_direct_spot;
#endif
#ifdef AMBIENT_DIFFUSE
TERM_OUTPUT(AMBIENT_DIFFUSE) vec4 out_ambient_diffuse;
#endif
#ifdef AMBIENT_SPECULAR
TERM_OUTPUT(AMBIENT_SPECULAR) vec4 out_ambient_specular;
#endif
#ifdef EMISSION
TERM_OUTPUT(EMISSION) vec4 out_emission;
#endif
#ifdef BACKGROUND
TERM_OUTPUT(BACKGROUND) vec4 out_background;
#endif
#ifdef REFLECTIONS  // added when all opaque surfaces are drawn (reflections_over.frag)
TERM_OUTPUT(REFLECTIONS) vec4 out_reflections;
#endif
#if defined(DIRECT_SUN) || defined(DIRECT_POINT) || defined(DIRECT_SPOT)
#define ANY_DIRECT
#endif
#ifdef LIGHT_GROUPS  // the light of so many groups of lights, from FIRST_GROUP on
TERM_OUTPUT(0) vec4 out_groups[LIGHT_GROUPS];
// Groups' numbers stand behind the lights.
uint group_of_light(uint light) {
  return ConstUintsRef(pc.lights + 64ul * uint64_t(frame.light_count)).u[light];
}
#endif

uint light_kind(LightRef light) { return floatBitsToUint(light_word(light, 3u).y); }

#ifdef FOG
vec3 through_fog = vec3(1.0);  // to the camera; the light of fog is a layer of its own (shaders/fog_layers.frag)
vec4 covering(vec3 radiance, float coverage) {
  return vec4(radiance * frame.pre_exposure * through_fog * coverage, coverage);
}
#else
vec4 covering(vec3 radiance, float coverage) { return vec4(radiance * frame.pre_exposure * coverage, coverage); }
#endif

void main() {
  if (!is_any_covered() || !is_put_out()) return;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
  Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  const float coverage = IS_MASKED != 0 ? 1.0 : surface_coverage(m, s.alpha);  // the pre-pass cut: shade_forward.frag
#ifdef FOG
  through_fog = fog_before_through(v.relative_position);
#endif
  const bool in_plane = HAS_SHADOWS || HAS_OCCLUSION != 0;
  vec3 plane_normal = in_plane ? triangle_normal(in_plane_position, to_viewer) : vec3(0.0);
  vec3 surface_point = in_plane ? onto_triangle(v.relative_position, plane_normal, in_plane_position)
                                : v.relative_position;
  round_off(plane_normal, surface_point);
#ifdef DEEP_SHADOWS
#if defined(REFRACTION) || defined(GLASS)
  own_absorbance = full_absorbance;
#else
  own_absorbance = absorbance_of(min(coverage, DEEP_SOLID));
#endif
#endif
  begin_rays(surface_point, plane_normal);
  BrdfTerms brdf;
  if (IS_UNLIT == 0) brdf = brdf_terms(s, to_viewer);
#ifdef REFRACTION
  const Refracted behind = refracted_light(in_ids.x, s, brdf, v, in_scale);
#endif
#if defined(REFRACTION) && !defined(SCATTERS)
  s.base_color *= 1.0 - behind.fraction;
  brdf.diffuse *= 1.0 - behind.fraction;
#endif
  // What unlit surfaces show counts as emission.
#ifdef EMISSION
  out_emission = covering(IS_UNLIT != 0 ? s.base_color : s.emission, coverage);
#endif
#if defined(AMBIENT_DIFFUSE) || defined(AMBIENT_SPECULAR)
  AmbientLobes ambient = AmbientLobes(vec3(0.0), vec3(0.0), vec3(0.0));
  if (HAS_AMBIENT != 0 && IS_UNLIT == 0) {
    shade_probes(s, brdf, v.relative_position);
    ambient = HAS_OCCLUSION != 0
        ? occluded_lobes(s, brdf, occlusion_open(surface_point, plane_normal, s, brdf.to_viewer), plane_normal)
        : ambient_lobes(s, brdf, s.normal);
    ambient.specular += ambient.lights;
  }
#ifdef FOG
  if (HAS_AMBIENT != 0 && IS_UNLIT == 0) {
    const vec3 sky = fog_sky_through_surface(v.relative_position, s.normal);
    ambient.diffuse *= sky;
    ambient.specular *= sky;
  }
#endif
  if (PROBE_COUNT != 0) ambient.specular += probes.specular;
#endif
#ifdef AMBIENT_DIFFUSE
  out_ambient_diffuse = covering(ambient.diffuse * s.occlusion, coverage);
#endif
#ifdef AMBIENT_SPECULAR
  out_ambient_specular = covering(ambient.specular * s.occlusion, coverage);
#endif
#ifdef ANY_DIRECT
  // Each sum takes its lights in the order of the whole.
  precise vec3 sun = vec3(0.0), point = vec3(0.0), spot = vec3(0.0);
  if (HAS_LIGHTS != 0 && IS_UNLIT == 0) {
    for (LightWalk w = begin_lights(v.relative_position); next_light(w);) {
      LightRef light = light_at(pc.lights, w.light);
      vec3 reaching = light_reaching(light, w.light, brdf, v.relative_position, surface_point, plane_normal);
#ifdef FOG
      if (reaching != vec3(0.0)) reaching *= fog_light_through(light, v.relative_position);
#endif
      const uint kind = light_kind(light);
      if (kind == light_directional)
        sun += reaching;
      else if (kind == light_point || kind == light_stand_in)
        point += reaching;
      else
        spot += reaching;
    }
  }
#endif
#ifdef DIRECT_SUN
  out_direct_sun = covering(sun, coverage);
#endif
#ifdef DIRECT_POINT
  out_direct_point = covering(point, coverage);
#endif
#ifdef DIRECT_SPOT
  out_direct_spot = covering(spot, coverage);
#endif
#ifdef LIGHT_GROUPS
  precise vec3 of_group[LIGHT_GROUPS];
  for (int i = 0; i < LIGHT_GROUPS; ++i) of_group[i] = vec3(0.0);
  if (HAS_LIGHTS != 0 && IS_UNLIT == 0) {
    for (LightWalk w = begin_lights(v.relative_position); next_light(w);) {
      LightRef light = light_at(pc.lights, w.light);
      vec3 reaching = light_reaching(light, w.light, brdf, v.relative_position, surface_point, plane_normal);
#ifdef FOG
      if (reaching != vec3(0.0)) reaching *= fog_light_through(light, v.relative_position);
#endif
      const int group = int(group_of_light(w.light)) - FIRST_GROUP;
      for (int i = 0; i < LIGHT_GROUPS; ++i)
        if (i == group) of_group[i] += reaching;
    }
  }
  for (int i = 0; i < LIGHT_GROUPS; ++i) out_groups[i] = covering(of_group[i], coverage);
#endif
#if defined(BACKGROUND) && defined(REFRACTION)
#ifdef FOG
  const FogSeen nearer = fog_before(v.relative_position);  // its light is no term
  const vec3 seen = refracted_through(behind, nearer.light, nearer.through);
#else
  const vec3 seen = behind.tint * behind.light.rgb;
#endif
  out_background = covering_picture(vec4(seen, 1.0), coverage);
#elif defined(BACKGROUND)
  out_background = covering(vec3(0.0), coverage);
#endif
#ifdef REFLECTIONS
  out_reflections = covering(vec3(0.0), coverage);
#endif
#ifdef STORED
  put_out(TERM, v.relative_position);
#endif
}
