#version 460
// The sky where nothing was drawn.
#include "lib/bindless.glsl"
#include "lib/frame.glsl"

#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SkyPush pc; };
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;
#ifdef FOG
#include "lib/fog.glsl"
#endif
layout(location = 0) in vec2 in_ndc;
layout(location = 0) out vec4 out_radiance;
#include "lib/sky_seen.glsl"

void main() {
  const vec3 direction = sky_direction(in_ndc);
  float step = max(length(dFdx(direction)), length(dFdy(direction)));
  if (IS_SUBSAMPLE != 0) step *= pc.subsample_footprint;
  const vec3 radiance = sky_radiance(direction, step);
#ifdef FOG
  const FogSeen fog = fog_before_sky(IS_SUBSAMPLE != 0 ? in_ndc + pc.subsample_ndc : in_ndc);
  out_radiance = vec4(radiance * fog.through, 1.0);
#ifndef WITHOUT_FOG_LIGHT
  out_radiance.rgb += fog.light;
#endif
#else
  out_radiance = vec4(radiance, 1.0);
#endif
}
