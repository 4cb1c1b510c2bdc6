#version 460
// A see-through surface in a light's view: how far off it is; with SLICES what it absorbs, and at which distance
// (passes/transparency/deep_shadows.h).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ColoredShadowPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/ambient.glsl"
#include "lib/draw.frag.glsl"
#include "lib/colored_shadows.glsl"
#include "lib/deep_shadows.glsl"
#ifdef GLASS
#include "lib/glass.glsl"
#endif

#ifdef SLICES
layout(location = 0) out vec4 out_all;
layout(location = 1) out vec4 out_slices[SLICES / 4];
#else
layout(location = 0) out vec4 out_range;
#endif

// What it takes of light that goes straight on, by channel. Bodies of glass send it elsewhere.
vec3 taken_of_light() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
#ifndef GLASS
  return vec3(surface_coverage(m, surface_base_color(m, v).a));
#else
  const vec3 to_light = direction_to_light(v.relative_position);
  const float facing = dot(v.normal, to_light) < 0.0 ? -1.0 : 1.0;
  const Surface s = load_surface(m, v, facing, to_light);
  const float covered = surface_coverage(m, s.alpha);
  const Glass glass = load_glass(in_ids.x);
  float fraction;
  const GlassPoint g = glass_point(glass, s, brdf_terms(s, to_light), v, in_scale, fraction);
  if (g.thickness_m > 0.0) return vec3(covered);
  const float x = 1.0 - clamp(dot(s.normal, to_light), 0.0, 1.0), x2 = x * x;
  const vec3 reflected =
      clamp(s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * (x2 * x2 * x), vec3(0.0), vec3(1.0));
  return (1.0 - glass_tint(glass, s, reflected, fraction, false, 0.0)) * covered;
#endif
}

void main() {
  // Farther than the light reaches a surface darkens nothing, whether it is culled or not.
  if (pc.light.w > 0.0 && distance(pc.light.xyz, in_position) > pc.light.w) discard;
  const bool parallel = pc.light.w == 0.0;
  const vec3 taken = taken_of_light();
  const bool is_solid = min(taken.r, min(taken.g, taken.b)) >= DEEP_SOLID;
  const float there = deep_distance(gl_FragCoord.z, parallel);
  if (!is_lit(gl_FragCoord.xy / float(pc.size_px), gl_FragCoord.z) || taken == vec3(0.0)) discard;
#ifndef SLICES
  // A texel's side, at this distance.
  const mat4 rows = transpose(pc.clip_from_relative);
  const float ndc_a_texel = 1.0 / (pc.place.x * float(pc.size_px));
  const float texel =
      ndc_a_texel / length(rows[0].xyz) * (parallel ? length(rows[2].xyz) : length(rows[3].xyz) * there);
  const vec2 part = is_solid ? vec2(0.0) : vec2(gl_FragCoord.z, there);
  out_range = vec4(part, is_solid ? gl_FragCoord.z : 0.0, DEEP_TEXELS * texel);
#else
  const vec4 stored = texelFetch(pass_array_images[pc.images >> 8u & 0xffu],
      ivec3(gl_FragCoord.xy, pc.layer & 0x7fffffffu), 0);
  const DeepRange range = deep_range(stored, parallel);
  if (is_solid || there > range.solid || !(range.width > 0.0)) discard;
  const vec3 kept = min(taken, vec3(DEEP_SOLID));
  const vec3 absorbed = vec3(absorbance_of(kept.r), absorbance_of(kept.g), absorbance_of(kept.b));
  const float mean = dot(absorbed, vec3(1.0 / 3.0));
  const float place = clamp(deep_place(range, there, SLICES), 0.0, float(SLICES - 1));
  out_all = vec4(absorbed, 0.0);
  for (int i = 0; i < SLICES / 4; ++i) out_slices[i] = mean * deep_weights(place, 4 * i);
#endif
}
