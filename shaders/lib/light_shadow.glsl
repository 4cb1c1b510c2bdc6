// How much of any light's rays come through, from its shadow maps. Needs lib/scene.glsl, lib/light_eval.glsl, the push
// constants of DrawPush, and a fragment shader. Only where HAS_SHADOWS.
#include "lib/image_kinds.glsl"
#include "lib/plane.glsl"
#include "shared/shadows.h"

// By how much a disc of lookups is turned in this pixel: interleaved gradient noise (Jimenez 2014).
float shadow_turn() {
  vec2 pixel = floor(gl_FragCoord.xy);
  if (IS_SUBSAMPLE != 0) pixel += 37.0 * pc.subsample_ndc * vec2(frame.size_px);  // each sample has its own turn
  return 6.2831853 * fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

#include "lib/lamp_shadow.glsl"
#include "lib/sun_shadow.glsl"

// 1 for lights without a map.
float light_visibility(LightRef light, vec3 position, vec3 normal) {
  const uint shadow = floatBitsToUint(light_word(light, 6u).y);
  if (shadow == 0u) return 1.0;
  // lavapipe 25.0.7 loads from an address that is the same in all lanes even where no lane takes the branch: it must be
  // valid.
  const bool is_lamp = (shadow & lamp_shadow_bit) != 0u;
  const uint place = max(shadow & ~lamp_shadow_bit, 1u) - 1u;
  if (HAS_SUN_SHADOWS == 0 || (HAS_LAMP_SHADOWS != 0 && is_lamp))
    return lamp_visibility(is_lamp ? place : 0u, position, normal);
  return sun_visibility(is_lamp ? 0u : place, position, normal);
}
