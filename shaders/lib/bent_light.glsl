#pragma once
// Where a corner of a body's front sends a light's ray. Part of colored_shadows.vert.
#include "lib/bend.glsl"
layout(constant_id = 45) const int STEPS = 3;

layout(location = 9) out vec2 out_from;    // texels, of the corner itself
layout(location = 10) out vec4 out_bends;  // cosine to the light, 1 where the ray lands, metres in the body, depth

vec4 landed(vec2 ndc) { return vec4(ndc, 0.5, 1.0); }  // evenly interpolated

// Of a lamp: so far beyond its view that what the maps have there is another's. Of the triangles that reach over an
// edge of the view some are kept.
bool is_beyond(vec2 ndc) { return pc.light.w != 0.0 && any(greaterThan(abs(ndc), vec2(1.25))); }

// From `at` along `inside`: the other side of the body, and its normal towards the inside. Unchanged where the light
// sees no back face.
void find_other_side(vec3 at, vec3 inside, vec3 away, inout vec3 exit, inout vec3 normal) {
  vec3 point = at;
  for (int i = 0; i < STEPS; ++i) {
    const vec4 clip = view_place(point);
    if (!(clip.w > 0.0)) break;
    if (any(greaterThan(abs(clip.xy), vec2(clip.w)))) break;  // not in the view
    const ivec2 texel = min(ivec2(layer_place(clip.xy / clip.w) * float(pc.size_px)), ivec2(pc.size_px) - 1);
    const vec4 there = texelFetch(pass_images[pc.images >> 8u & 0xffu], texel, 0);
    const vec3 outwards = texelFetch(pass_images[pc.images >> 16u & 0xffu], texel, 0).xyz;
    if (there.w == 0.0 || !(dot(there.xyz - at, away) > 0.0)) break;  // nothing, or another body's before this one
    const float towards = dot(inside, outwards);
    const float way = dot(there.xyz - at, outwards) / towards;
    if (!(towards > 1e-3) || !(way > 0.0)) break;
    point = at + inside * way;
    exit = point;
    normal = -outwards;
  }
}

vec4 placed() {
  const vec4 here = view_place(out_position);
  const vec3 to_light = direction_to_light(out_position);
  const float facing = dot(out_normal, to_light);
  const Glass glass = load_glass(out_ids.x);
  const float ior = glass.ior >= 1.0 ? glass.ior : 1.0;
  const vec2 ndc = here.xy / here.w;
  out_from = layer_place(ndc) * float(pc.size_px);
  out_bends = vec4(facing, 0.0, 0.0, here.z / here.w);
  if (!(glass.thickness_m > 0.0) || !(here.w > 0.0) || is_beyond(ndc)) return landed(ndc);
  // A triangle across the outline has corners that look away: there light grazes.
  vec3 normal = normalize_or(out_normal + to_light * max(0.01 - facing, 0.0), to_light);
  const vec3 inside = bent(-to_light, normal, 1.0 / ior);
  vec3 exit = out_position + inside * clamp(glass.thickness_m * out_scale, 0.0, 1e15);
  find_other_side(out_position, inside, -to_light, exit, normal);
  const vec3 leaving = refract(inside, normal, ior);
  if (!(dot(leaving, leaving) > 0.25)) return landed(ndc);  // all of it is reflected
  // On to what is opaque: to the depth that the maps have where the ray is, step by step.
  const vec4 from = pc.clip_from_relative * vec4(exit, 1.0), along = pc.clip_from_relative * vec4(leaving, 0.0);
  vec4 at = from;
  for (int i = 0; i < STEPS; ++i) {
    if (!(at.w > 0.0) || is_beyond(at.xy / at.w)) return landed(ndc);
    const float depth = opaque_depth(layer_place(at.xy / at.w));
    const float way = max((depth * from.w - from.z) / (along.z - depth * along.w), 0.0);
    if (isnan(way) || isinf(way)) return landed(ndc);  // it leaves the scene
    at = from + along * way;
  }
  if (!(at.w > 0.0)) return landed(ndc);
  out_bends.y = 1.0;
  out_bends.z = length(exit - out_position);
  return landed(at.xy / at.w);
}
