#version 460
// Metallic-roughness shading of fragments under the lights of their lists, or all of them.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/shade.glsl"
#include "lib/draw.frag.glsl"
#ifdef REFRACTION
#include "lib/refraction.glsl"
#elif defined(GLASS)
#include "lib/glass.glsl"
#endif
#include "lib/blended.glsl"
#include "lib/covered.glsl"
#if defined(BEHIND) || defined(BEFORE)
#include "lib/behind.glsl"
#endif

void main() {
#if defined(BEHIND) || defined(BEFORE)
  keep_part();
#endif
  if (!is_any_covered() || !is_put_out()) return;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
  Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  // What a mask cuts away is not in the depth that this one equals. It is not asked again: the centroid of the samples
  // that passed the depth test may lie in a hole, and the kept sample would belong to no triangle.
  const float coverage = IS_MASKED != 0 ? 1.0 : surface_coverage(m, s.alpha);
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
  BrdfTerms brdf = brdf_terms(s, to_viewer);
#ifdef REFRACTION
  const Refracted behind = refracted_light(in_ids.x, s, brdf, v, in_scale);
#elif defined(GLASS)
  const GlassSums behind = glass_sums(m, in_ids.x, s, brdf, v, in_scale);
#endif
#if (defined(REFRACTION) || defined(GLASS)) && !defined(SCATTERS)  // where it has them the base knows already
  s.base_color *= 1.0 - behind.fraction;
  brdf.diffuse *= 1.0 - behind.fraction;
#endif
  precise vec3 radiance = surface_radiance(s, brdf, v.relative_position, surface_point, plane_normal);
#ifdef REFRACTION
  // What lies behind is seen through all of the fog before it; the fog before the glass is in it already.
  const float covered = 1.0 - max(behind.tint.r, max(behind.tint.g, behind.tint.b)) * (1.0 - behind.light.a);
#ifdef FOG
  const FogSeen fog = fog_before(v.relative_position);
  const vec3 through = refracted_through(behind, fog.light, fog.through);
  const vec3 seen = radiance * frame.pre_exposure * fog.through + through + fog.light;
#else
  const vec3 seen = radiance * frame.pre_exposure + behind.tint * behind.light.rgb;
#endif
  put_out(covering_picture(vec4(seen, covered), coverage), v.relative_position);
#elif defined(GLASS)
  radiance *= frame.pre_exposure;
#ifdef FOG
  const FogSeen fog = fog_before(v.relative_position);
  radiance = radiance * fog.through + fog.light * (1.0 - behind.tint);
#endif
  put_glass(radiance, behind, v.relative_position);
#elif defined(FOG)
  const FogSeen fog = fog_before(v.relative_position);
  put_out(vec4((radiance * frame.pre_exposure * fog.through + fog.light) * coverage, coverage), v.relative_position);
#else
  put_out(vec4(radiance * frame.pre_exposure * coverage, coverage), v.relative_position);
#endif
}
