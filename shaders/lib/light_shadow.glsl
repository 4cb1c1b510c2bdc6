// How much of any light's rays come through, from its shadow maps. Needs lib/scene.glsl, lib/light_eval.glsl, the push
// constants of DrawPush, and a fragment shader. Only where HAS_SHADOWS.
#include "lib/image_kinds.glsl"
#include "lib/plane.glsl"
#include "shared/shadows.h"

// By how much a disc of lookups is turned in this pixel: interleaved gradient noise (Jimenez 2014).
float shadow_turn() {
  vec2 pixel = floor(PIXEL_MIDDLE);
  if (IS_SUBSAMPLE != 0) pixel += 37.0 * pc.subsample_ndc * vec2(frame.size_px);  // each sample has its own turn
  precise float noise = 52.9829189 * fract(pixel.x * 0.06711056 + pixel.y * 0.00583715);
  return 6.2831853 * fract(noise);
}

#include "lib/pixel_span.glsl"
#include "lib/traced_light.glsl"
#include "lib/sun_shadow.glsl"
#include "lib/lamp_shadow.glsl"
#ifdef RELIEFS
#include "lib/relief_light.glsl"
#endif
#ifdef COLORED_SHADOWS
#include "lib/shadow_color.glsl"
#endif

#ifdef DEEP_SHADOWS
#include "lib/deep_light.glsl"
float own_absorbance = 0.0;  // of the surface that is shaded; a shader of blended surfaces sets it

vec3 deep_shadow(LightRef light, vec3 position, vec3 normal) {
  const uint shadow = floatBitsToUint(light_word(light, 6u).y);
  if (shadow == 0u) return vec3(1.0);
  const bool is_lamp = (shadow & lamp_shadow_bit) != 0u;
  const uint place = max(shadow & ~lamp_shadow_bit, 1u) - 1u;  // valid in all lanes, as in light_visibility
#if (DEEP_SHADOWS & 2) != 0
  if (is_lamp) return deep_lamp(place, position, normal, own_absorbance);
#endif
#if (DEEP_SHADOWS & 1) != 0
  if (!is_lamp) return deep_sun(place, position, normal, own_absorbance);
#endif
  return vec3(1.0);
}
#endif

// 1 for lights without a map. Traced lights: of the point that begin_rays was called for. Of lights with a size the
// part that is seen. number: the light's, for its own places on it.
float light_visibility_of_meshes(LightRef light, uint number, vec3 position, vec3 normal) {
  if (SUNS_TRACED || LAMPS_TRACED) {
    const bool is_sun = floatBitsToUint(light_word(light, 3u).y) == light_directional;
    if (is_sun ? SUNS_TRACED : LAMPS_TRACED) return traced_visibility(light, number);
    const uint named = floatBitsToUint(light_word(light, 6u).y);
    // Valid in all lanes, also those of the lights that are traced.
    const uint own = is_sun == SUNS_TRACED ? 0u : max(named & ~lamp_shadow_bit, 1u) - 1u;
    if (named == 0u) return 1.0;
    if (SUNS_TRACED) return HAS_LAMP_SHADOWS != 0 ? lamp_visibility(own, light, position, normal) : 1.0;
    return HAS_SUN_SHADOWS != 0 ? sun_visibility(own, position, normal) : 1.0;
  }
  const uint shadow = floatBitsToUint(light_word(light, 6u).y);
  if (shadow == 0u) return 1.0;
  // lavapipe 25.0.7 loads from an address that is the same in all lanes even where no lane takes the branch: it must be
  // valid.
  const bool is_lamp = (shadow & lamp_shadow_bit) != 0u;
  const uint place = max(shadow & ~lamp_shadow_bit, 1u) - 1u;
  if (HAS_SUN_SHADOWS == 0 || (HAS_LAMP_SHADOWS != 0 && is_lamp))
    return lamp_visibility(is_lamp ? place : 0u, light, position, normal);
  return sun_visibility(is_lamp ? 0u : place, position, normal);
}

float light_visibility(LightRef light, uint number, vec3 position, vec3 normal) {
  float seen = light_visibility_of_meshes(light, number, position, normal);
#ifdef RELIEFS
  if (seen > 0.0) seen *= relief_visibility(light, position);
#endif
  return seen;
}

// A light's part of the radiance, as far as it comes through. surface_point, plane_normal: where its triangle is.
vec3 light_reaching(LightRef light, uint number, BrdfTerms brdf, vec3 position, vec3 surface_point, vec3 plane_normal) {
#ifdef LOBED
  if (HAS_PASSING) {
#if defined(SCATTERS) && defined(TRACES)
    rays_from.position = rays_begin;
#endif
    lit_plane = plane_normal;
    vec3 l;
    light_arriving(light, position, l);
    if (dot(plane_normal, l) < 0.0) {
      plane_normal = -plane_normal;  // of the side that the light is on
#ifdef SCATTERS
      surface_point += plane_normal * brdf.lobes.slab_m;  // where light comes into the slab
#ifdef TRACES
      rays_from.position = rays_begin + plane_normal * brdf.lobes.slab_m;
#endif
#endif
    }
  }
#endif
  if ((SUNS_SOFT && SUNS_TRACED) || (LAMPS_SOFT && LAMPS_TRACED)) {
    const bool is_sun = floatBitsToUint(light_word(light, 3u).y) == light_directional;
    if (is_sun ? SUNS_SOFT && SUNS_TRACED : LAMPS_SOFT && LAMPS_TRACED && light_word(light, 7u).x > 0.0)
      return traced_soft_light(light, number, brdf, position);
  }
  vec3 reaching = light_contribution(light, brdf, position);
  if (HAS_SHADOWS && reaching != vec3(0.0)) reaching *= light_visibility(light, number, surface_point, plane_normal);
#ifdef COLORED_SHADOWS
  if (reaching != vec3(0.0)) reaching *= shadow_color(light, surface_point);
#endif
#ifdef DEEP_SHADOWS
  if (reaching != vec3(0.0)) reaching *= deep_shadow(light, surface_point, plane_normal);
#endif
  return reaching;
}
