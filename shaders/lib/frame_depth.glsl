#pragma once
// Reversed depth of a sample of the frame: of an image, pc.depth, or of a visibility buffer's keys, pc.keys (KEYS).
// Needs lib/frame.glsl and lib/bindless.glsl.
#ifdef KEYS
#include "shared/visibility.h"
#endif

float frame_depth(ivec2 p, int s, int samples) {
#ifdef KEYS
  const uint place = (uint(p.y) * frame.size_px.x + uint(p.x)) * uint(samples) + uint(s);
  return uintBitsToFloat(uint(KeysRef(pc.keys).k[place] >> 32));
#else
  return samples > 1 ? texelFetch(pass_multisampled_images[pc.depth], p, s).r
      : texelFetch(pass_images[pc.depth], p, 0).r;
#endif
}
