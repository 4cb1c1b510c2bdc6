#version 460
// The same behind everything.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SkyPush pc; };
#include "lib/frame.glsl"
#include "lib/fog.glsl"
layout(location = 0) in vec2 in_ndc;
#ifdef LIGHT
layout(location = LIGHT) out vec4 out_light;  // pre-exposed
#endif
#ifdef TRANSMITTANCE
layout(location = TRANSMITTANCE) out vec4 out_transmittance;
#endif

void main() {
  const FogSeen fog = fog_before_sky(in_ndc + pc.subsample_ndc);
#ifdef LIGHT
  out_light = vec4(fog.light, 1.0);
#endif
#ifdef TRANSMITTANCE
  out_transmittance = vec4(fog.through, 1.0);
#endif
}
