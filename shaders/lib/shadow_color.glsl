#pragma once
// What see-through surfaces leave of a light's rays at an opaque point, by channel; more than 1 where a body gathers
// light (passes/transparency/colored_shadows.h). COLORED_SHADOWS: 1 suns have such images, 2 lamps, 4 with light that
// bodies bend. Part of lib/light_shadow.glsl.
vec3 shadow_color_at(uint image, vec2 uv, float layer) {
  const vec4 taken = textureLod(sampler2DArray(pass_array_images[image], graph_samplers[SAMPLER_LINEAR_CLAMP]),
      vec3(uv, layer), 0.0);
  vec3 left = vec3(1.0 - taken.a);
#if (COLORED_SHADOWS & 4) != 0
  const float layers = 0.5 * float(textureSize(pass_array_images[image], 0).z);
  left += textureLod(sampler2DArray(pass_array_images[image], graph_samplers[SAMPLER_LINEAR_CLAMP]),
      vec3(uv, layers + layer), 0.0).rgb;
#endif
  return left * (1.0 - taken.rgb);
}

#if (COLORED_SHADOWS & 1) != 0
vec3 sun_shadow_color(uint sun, vec3 position) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const CascadePlace place = find_cascade(sun, position);
  if (place.number == max_sun_cascades) return vec3(1.0);
  const vec2 across =
      vec2(dot(suns.s[sun].right, position), dot(suns.s[sun].up, position)) - place.cascade.centre_m;
  const vec2 uv = vec2(0.5) + vec2(across.x, -across.y) * (0.5 / place.cascade.half_m);
  return shadow_color_at(pc.shadow_colors & 0xffu, uv, float(suns.s[sun].first_layer + place.number));
}
#endif

#if (COLORED_SHADOWS & 2) != 0
vec3 lamp_shadow_color(uint number, vec3 position) {
  LampRef lamp = lamp_at(number);
  const LampPosition from = lamp_position(lamp);
  const vec3 q = position - from.position;
  const LampFace side = lamp_face(lamp, from.form, q);
  if (!(side.z > lamp_near_m) || side.tile.z < 0.0) return vec3(1.0);
  const LampScale scale = lamp_scale(lamp);
  const float most = scale.most_tangent;
  const vec2 tangent = clamp(vec2(dot(side.right, q), -dot(side.up, q)) / side.z, vec2(-most), vec2(most));
  return shadow_color_at(pc.shadow_colors >> 16u & 0xffu,
      (side.tile.xy + tangent / scale.texel_tangent) * scale.uv_per_texel, side.tile.z);
}
#endif

vec3 shadow_color(LightRef light, vec3 position) {
  const uint shadow = floatBitsToUint(light_word(light, 6u).y);
  if (shadow == 0u) return vec3(1.0);
  const bool is_lamp = (shadow & lamp_shadow_bit) != 0u;
  const uint place = max(shadow & ~lamp_shadow_bit, 1u) - 1u;  // valid in all lanes, as in light_visibility
#if (COLORED_SHADOWS & 2) != 0
  if (is_lamp) return lamp_shadow_color(place, position);
#endif
#if (COLORED_SHADOWS & 1) != 0
  if (!is_lamp) return sun_shadow_color(place, position);
#endif
  return vec3(1.0);
}
