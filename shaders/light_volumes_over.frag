#version 460
// The sum of all lights of a sample, exposed and through the fog before it.
#define TRIANGLES
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#endif
layout(location = 0) out vec4 out_radiance;

void main() {
  pixel_middle = floor(gl_FragCoord.xy) + 0.5;
  const ivec2 at = ivec2(gl_FragCoord.xy);
  const int s = int(pc.own);
  gl_SampleMask[0] = 1 << s;
  out_radiance = vec4(0.0);
  GBufferSample g;
  load_texels(g, at, s, 0, texels_of_position);
  if (!is_seen(g)) return;
  const uint sum = uint(pc.table >> 60) & 15u;
  vec3 radiance =
      (SAMPLES > 1 ? texelFetch(pass_multisampled_images[sum], at, s) : texelFetch(pass_images[sum], at, 0)).rgb;
#ifndef EXPOSED
  radiance *= frame.pre_exposure;
#endif
#ifdef FOG
  const FogSeen fog = fog_before(position_of(own_texels(g)));
  radiance = radiance * fog.through + fog.light;
#endif
  out_radiance = vec4(radiance, 1.0);
}
