#version 460
// One colour where nothing was drawn.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { BackgroundPush pc; };
layout(location = 0) in vec2 in_ndc;
layout(location = 0) out vec4 out_radiance;
#ifdef FOG
#include "lib/frame.glsl"
#include "lib/fog.glsl"
// What is not seen through fog covers what is behind the picture, by its luminance.
void main() {
  const FogSeen fog = fog_before_sky(in_ndc + pc.subsample_ndc);
  const float through = dot(fog.through, vec3(0.2126, 0.7152, 0.0722));
  out_radiance = vec4(pc.color.rgb * fog.through, 1.0 - through * (1.0 - pc.color.a));
#ifndef WITHOUT_FOG_LIGHT
  out_radiance.rgb += fog.light;
#endif
}
#else
void main() { out_radiance = pc.color; }
#endif
