#version 460
// What a see-through surface takes of a light's rays; with BENDS what a body of glass sends to where this fragment is,
// over the light of the place itself.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ColoredShadowPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/ambient.glsl"
#include "lib/draw.frag.glsl"
#include "lib/colored_shadows.glsl"
#ifdef GLASS
#include "lib/glass.glsl"
#endif
#ifdef BENDS
layout(location = 9) in vec2 in_from;
layout(location = 10) in vec4 in_bends;
const float most_gathered = 4096.0;  // times the light of the place: sums of many stay halves

// -1 to 1 in the view, of a place in texels.
vec2 in_view(vec2 texels) { return (texels / float(pc.size_px) - pc.place.zw) / pc.place.xy; }
// How much of a light's rays a texel has there, over the middle of its view: a lamp's texels are farther off the more
// aslant it sees them.
float share_of_light(vec2 ndc) {
  if (pc.light.w == 0.0) return 1.0;
  const mat4 m = pc.clip_from_relative;
  const vec2 tangent = ndc * inversesqrt(vec2(m[0].x * m[0].x + m[1].x * m[1].x + m[2].x * m[2].x,
                                              m[0].y * m[0].y + m[1].y * m[1].y + m[2].y * m[2].y));
  const float square = 1.0 / (1.0 + dot(tangent, tangent));
  return square * sqrt(square);
}
#endif

layout(location = 0) out vec4 out_taken;

void main() {
  // Farther than the light reaches a surface darkens nothing, whether it is culled or not.
  if (pc.light.w > 0.0 && distance(pc.light.xyz, in_position) > pc.light.w) discard;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
#ifndef GLASS
  const float covered = surface_coverage(m, surface_base_color(m, v).a);
  if (!is_lit(gl_FragCoord.xy / float(pc.size_px), gl_FragCoord.z)) discard;
  out_taken = vec4(vec3(covered), 0.0);
#else
  const vec3 to_light = direction_to_light(v.relative_position);
  const float facing = dot(v.normal, to_light) < 0.0 ? -1.0 : 1.0;
  const Surface s = load_surface(m, v, facing, to_light);
  const float covered = surface_coverage(m, s.alpha);
  const BrdfTerms brdf = brdf_terms(s, to_light);
  const Glass glass = load_glass(in_ids.x);
  float fraction;
  const GlassPoint g = glass_point(glass, s, brdf, v, in_scale, fraction);
  const bool is_body = g.thickness_m > 0.0;
  const float x = 1.0 - clamp(dot(s.normal, to_light), 0.0, 1.0), x2 = x * x;
  const vec3 reflected =
      clamp(s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * (x2 * x2 * x), vec3(0.0), vec3(1.0));
#ifdef BENDS
  const vec2 from = in_view(in_from);
  const float area = abs(determinant(mat2(dFdx(in_from), dFdy(in_from))));
  const float gathered =
      min(area * (share_of_light(from) / share_of_light(in_view(gl_FragCoord.xy))), most_gathered);
  const vec3 tint = glass_tint(glass, s, reflected, fraction, is_body, in_bends.z);
  // What begins beyond the view is another's, or nobody's: its texels have next to no light each.
  const bool lands = in_bends.x > 0.0 && in_bends.y > 0.999 && is_body && all(lessThanEqual(abs(from), vec2(1.0)));
  if (!lands || !is_lit(in_from / float(pc.size_px), in_bends.w)) discard;
  out_taken = vec4(tint * (gathered * covered), 0.0);
#else
  const vec3 tint = glass_tint(glass, s, reflected, fraction, is_body, g.thickness_m);
  // The far side of a body is counted by the near one.
  if ((is_body && facing < 0.0) || !is_lit(gl_FragCoord.xy / float(pc.size_px), gl_FragCoord.z)) discard;
  out_taken = vec4((1.0 - tint) * covered, 0.0);
#ifdef BODIES_BLOCK
  if (is_body) out_taken = vec4(0.0, 0.0, 0.0, covered);
#endif
#endif
#endif
}
