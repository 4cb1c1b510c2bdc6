#pragma once
// One sample of images that have as many as the picture, and that sample alone as what a triangle covers. Needs a push
// constant pc.sample_number.
#include "lib/bindless.glsl"
layout(constant_id = 0) const int SAMPLES = 1;

vec4 fetch_sample(uint image) {
  const ivec2 p = ivec2(gl_FragCoord.xy);
  return SAMPLES > 1 ? texelFetch(pass_multisampled_images[image], p, int(pc.sample_number))
      : texelFetch(pass_images[image], p, 0);
}
void cover_sample() { gl_SampleMask[0] = int(1u << pc.sample_number); }
