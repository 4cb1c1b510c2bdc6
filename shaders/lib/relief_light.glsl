#pragma once
#define RELIEF_LIGHT
// Light on its way through the layer of the relief that is shaded. Shadow maps hold what lies before the layer, by the
// triangles through which a light's rays come in: not what they meet that come in by the layer's ends, and nothing that
// is narrower than a texel. So a ray goes from the point towards the light, as far as up through the triangle's plane:
// from texel to texel, or in even steps (Policarpo, Oliveira, Comba 2005). Lights with a size: towards their middle.
// Needs lib/relief.glsl, lib/light_eval.glsl.
#include "lib/relief.glsl"
// The surface's own roughness, of the layer: what the filter of a device, whose weights are 256ths, may be off by.
const float RELIEF_LIGHT_LIFT = 1.0 / 256.0;
Relief lit_relief;
vec3 lit_at;
float lit_lod;
bool lit_on_relief = false;

// at: its place in the layer, from heights of level lod.
void begin_relief_light(Relief layer, vec3 at, float lod, bool back) {
  lit_relief = layer;
  lit_at = at;
  lit_lod = lod;
  lit_on_relief = RELIEF_LIGHT_STEPS >= 0 && !back;
}
void end_relief_light() { lit_on_relief = false; }

// 1: lit, 0: in the relief's own shadow. 1 for lights without a map.
float relief_visibility(LightRef light, vec3 position) {
  if (!lit_on_relief || floatBitsToUint(light_word(light, 6u).y) == 0u) return 1.0;
  const vec2 z_type = light_word(light, 3u);
  const bool is_sun = floatBitsToUint(z_type.y) == light_directional;
  if (is_sun ? SUNS_TRACED : LAMPS_TRACED) return 1.0;
  vec3 row[3];
  if (!relief_rows(lit_relief, row)) return 1.0;
  const vec3 way = is_sun ? -vec3(light_word(light, 2u), z_type.x)
      : vec3(light_word(light, 0u), light_word(light, 1u).x) - position;
  const vec3 by = vec3(dot(row[0], way), dot(row[1], way), dot(row[2], way));
  vec3 at = lit_at;
  if (RELIEF_LIGHT_STEPS > 0)
    at.z -= RELIEF_LIGHT_LIFT + (RELIEF_STEPS > 0 ? exp2(-float(RELIEF_REFINEMENTS)) / float(RELIEF_STEPS) : 0.0);
  float end = RELIEF_FARTHEST / max(max(abs(by.x), abs(by.y)), 1e-30);
  if (!is_sun) end = min(end, 1.0);
  if (by.z > 0.0) end = min(end, (1.0 - at.z) / by.z);
  if (by.z < 0.0) end = min(end, -at.z / by.z);
  if (!(end > 0.0)) return 1.0;
  const bool above = RELIEF_LIGHT_STEPS > 0;  // the exact end finds where it comes out of what its place is off by
  return relief_between(lit_relief, at, at + end * by, above, lit_lod, RELIEF_LIGHT_STEPS, 0).met ? 0.0 : 1.0;
}
