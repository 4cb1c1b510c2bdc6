#pragma once
// The side of a lamp's shadow maps that a direction from the lamp meets. Needs pc.lamps.
#include "shared/shadows.h"

// A 64-bit word of a LampShadow. llvmpipe gathers every word lane by lane, which is much of what a lookup costs there.
vec2 lamp_word(LampRef lamp, uint word) { return uintBitsToFloat(unpackUint2x32(lamp.w[word])); }
LampRef lamp_at(uint number) { return LampRef(pc.lamps + 120ul * number); }

struct LampPosition {
  vec3 position;
  uint form;  // of LampShadow
};
LampPosition lamp_position(LampRef lamp) {
  const vec2 z_form = lamp_word(lamp, 1u);
  return LampPosition(vec3(lamp_word(lamp, 0u), z_form.x), floatBitsToUint(z_form.y));
}
// Of LampShadow.
struct LampScale {
  float texel_tangent, most_tangent, uv_per_texel, bias_m;
};
LampScale lamp_scale(LampRef lamp) {
  const vec2 tangents = lamp_word(lamp, 2u), rest = lamp_word(lamp, 3u);
  return LampScale(tangents.x, tangents.y, rest.x, rest.y);
}

struct LampFace {
  vec3 right, up, forward;
  float z;    // of the direction along the side's own axis; not above 0 behind a spot
  vec3 tile;  // middle in texels, and layer
};
LampFace lamp_face(LampRef lamp, uint form, vec3 d) {
  LampFace f;
  uint side = 0u;
  if ((form & 1u) != 0u) {
    const vec3 a = abs(d);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const float along = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
    f.right = axis == 0 ? vec3(0.0, 1.0, 0.0) : axis == 1 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    f.up = f.right.zxy;
    f.forward = f.up.zxy * (along < 0.0 ? -1.0 : 1.0);
    side = 2u * uint(axis) + (along < 0.0 ? 1u : 0u);
  } else {
    const vec2 right = lamp_word(lamp, 4u), right_up = lamp_word(lamp, 5u), up = lamp_word(lamp, 6u);
    f.right = vec3(right, right_up.x);
    f.up = vec3(right_up.y, up);
    f.forward = vec3(lamp_word(lamp, 7u), lamp_word(lamp, 8u).x);
  }
  f.z = dot(f.forward, d);
  const vec2 tile = lamp_word(lamp, 9u + side);
  const uint middle = floatBitsToUint(tile.x);
  f.tile = vec3(float(middle & 0xffffu), float(middle >> 16u), tile.y);
  return f;
}
