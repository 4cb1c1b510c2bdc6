#pragma once
// The cascade of a directional light that covers a point. Needs the push constants pc.suns and pc.sun_maps.
#include "lib/image_kinds.glsl"
#include "lib/unfused_dot.glsl"
#include "shared/shadows.h"

struct CascadePlace {
  SunCascade cascade;
  uint number;      // max_sun_cascades: no cascade covers the point
  float to_edge;    // 0 in the middle of what it covers, 1 at the edge
};
CascadePlace find_cascade(uint sun, vec3 position) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  CascadePlace place;
  place.number = max_sun_cascades;
  const vec2 across = vec2(unfused_dot(suns.s[sun].right, position), unfused_dot(suns.s[sun].up, position));
  if (dot(suns.s[sun].depth, vec4(position, 1.0)) < 0.0) return place;
  const uint count = suns.s[sun].cascade_count;
  for (uint c = 0u; c < count; ++c) {
    const SunCascade cascade = suns.s[sun].cascades[c];
    precise vec2 off = abs(across - cascade.centre_m);
    const float farthest = max(off.x, off.y);
    if (farthest <= cascade.covered_m) {
      place.cascade = cascade;
      place.number = c;
      place.to_edge = farthest / cascade.covered_m;
      break;
    }
  }
  return place;
}
