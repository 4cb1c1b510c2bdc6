#pragma once
// A view of a light, and its shadow maps. Needs lib/scene.glsl and the push constants of ColoredShadowPush.
#include "lib/image_kinds.glsl"

// Clip space. What lies before the near plane of a parallel view is flattened onto it, as in depth_view.vert.
vec4 view_place(vec3 relative) {
  vec4 clip = pc.clip_from_relative * vec4(relative, 1.0);
  if ((pc.layer & 0x80000000u) != 0u) clip.z = min(clip.z, clip.w);
  return clip;
}
vec3 direction_to_light(vec3 relative) {
  return pc.light.w == 0.0 ? pc.light.xyz : normalize(pc.light.xyz - relative);
}
vec2 layer_place(vec2 ndc) { return ndc * pc.place.xy + pc.place.zw; }  // 0 to 1

vec3 maps_place(vec2 place) { return vec3(place, float(pc.layer & 0x7fffffffu)); }
// Reversed depth of what is opaque.
float opaque_depth(vec2 place) {
  return textureLod(sampler2DArray(pass_array_images[pc.images & 0xffu], graph_samplers[SAMPLER_NEAREST_CLAMP]),
      maps_place(place), 0.0).r;
}
// Of the four texels about a place: whether one has nothing opaque before the depth.
bool is_lit(vec2 place, float depth) {
  const vec4 d = textureGather(
      sampler2DArray(pass_array_images[pc.images & 0xffu], graph_samplers[SAMPLER_NEAREST_CLAMP]), maps_place(place));
  return depth >= min(min(d.x, d.y), min(d.z, d.w)) * 0.999999;
}
