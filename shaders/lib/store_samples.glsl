#pragma once
// Where a pass in compute leaves the colour of each sample (passes/surfaces/sample_store.h). Needs lib/frame.glsl,
// SAMPLES, and of DrawPush as pc: own, the image's place; deformed_before, the buffer.
#include "lib/bindless.glsl"
#if STORE == 2
layout(set = 1, binding = 1) uniform writeonly image2DMS storage_multisampled_images[8];
#endif

// which: a bit for each of the pixel's samples.
void store_samples(ivec2 pixel, uint which, vec4 radiance) {
#if STORE == 1
  imageStore(storage_images[pc.own], pixel, radiance);
#else
  const uint first = (uint(pixel.y) * frame.size_px.x + uint(pixel.x)) * uint(SAMPLES);
  for (int s = 0; s < SAMPLES; ++s) {
    if ((which >> s & 1u) == 0u) continue;
#if STORE == 2
    imageStore(storage_multisampled_images[pc.own], pixel, s, radiance);
#else
    SamplesRef(pc.deformed_before).s[first + uint(s)] = radiance;
#endif
  }
#endif
}
