#pragma once
// Whether a point of the air sees a lamp, from its depth maps: linear between the comparisons with four texels. The air
// has no plane that could darken itself, so nothing but rounding is left for a bias. Needs pc.lamps and pc.lamp_maps.
#include "lib/image_kinds.glsl"
#include "lib/lamp_face.glsl"

// Of a light's words: its place among the frame's LampShadows; no_light: it has no maps.
uint fog_lamp_maps(LightRef light) {
  const uint named = floatBitsToUint(light_word(light, 6u).y);
  return (named & lamp_shadow_bit) != 0u ? max(named & ~lamp_shadow_bit, 1u) - 1u : no_light;
}

// 1: lit, 0: in shadow, for a lamp that may be no_light. position: relative.
float fog_lamp_visibility(uint maps, vec3 position) {
  // Valid in all lanes: light_visibility in lib/light_shadow.glsl.
  LampRef lamp = lamp_at(maps == no_light ? 0u : maps);
  const LampPosition from = lamp_position(lamp);
  const vec3 q = position - from.position;
  const LampFace side = lamp_face(lamp, from.form, q);
  const vec3 tile = side.tile;
  const float z = side.z;
  if (maps == no_light || !(z > lamp_near_m) || tile.z < 0.0) return 1.0;
  const LampScale scale = lamp_scale(lamp);
  const float most = scale.most_tangent;
  const vec2 tangent = clamp(vec2(dot(side.right, q), -dot(side.up, q)) / z, vec2(-most), vec2(most));
  // From the tile's middle: where the tile is must not matter to the last bit.
  const vec2 place = tangent / scale.texel_tangent - 0.5, whole = floor(place), f = place - whole;
  const vec2 corner = (tile.xy + whole + 1.0) * scale.uv_per_texel;
  const float bias = scale.bias_m / z + 9.5367432e-7;
  const vec4 stored = textureGather(
      sampler2DArray(pass_array_images[pc.lamp_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]), vec3(corner, tile.z));
  const vec4 lit = vec4(greaterThanEqual(vec4(lamp_near_m / z * (1.0 + bias)), stored));
  return mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
}
