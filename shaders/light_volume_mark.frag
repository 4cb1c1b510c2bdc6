#version 460
// Marks the samples that hold the same bits in the G-buffer, where this one is the first of the pixel that holds them.
#define TRIANGLES
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"

void main() {
  pixel_middle = floor(gl_FragCoord.xy) + 0.5;
  const ivec2 at = ivec2(gl_FragCoord.xy);
  const int s = int(pc.own);
  const int same = samples_first_held(load_gbuffer(at, s), at, s);
  if (same == 0) discard;
  gl_SampleMask[0] = same;
}
