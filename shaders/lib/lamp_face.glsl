#pragma once
// The side of a lamp's shadow maps that a direction from the lamp meets. Needs pc.lamps.
#include "shared/shadows.h"

struct LampFace {
  vec3 right, up, forward;
  float z;    // of the direction along the side's own axis; not above 0 behind a spot
  vec3 tile;  // of LampShadow
};
LampFace lamp_face(uint lamp, vec3 d) {
  LampShadowsRef lamps = LampShadowsRef(pc.lamps);
  vec3 forward = lamps.s[lamp].forward;
  LampFace f;
  f.right = lamps.s[lamp].right, f.up = lamps.s[lamp].up;
  uint side = 0u;
  if (lamps.s[lamp].is_cube != 0u) {
    const vec3 a = abs(d);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const float along = axis == 0 ? d.x : axis == 1 ? d.y : d.z;
    f.right = axis == 0 ? vec3(0.0, 1.0, 0.0) : axis == 1 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    f.up = f.right.zxy;
    forward = f.up.zxy * (along < 0.0 ? -1.0 : 1.0);
    side = 2u * uint(axis) + (along < 0.0 ? 1u : 0u);
  }
  f.forward = forward;
  f.z = dot(forward, d);
  f.tile = lamps.s[lamp].tiles[side];
  return f;
}
