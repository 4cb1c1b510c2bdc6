#version 460
// Every sample of a multisampled image as 32-bit words, for hashing: such an image cannot be copied to a buffer. A
// pixel's samples follow one another, and each is as many words as its format has channels.
#include "shared/hash.h"
layout(push_constant, scalar) uniform Push { HashSamplesPush pc; };
#include "lib/bindless.glsl"
layout(set = 1, binding = 0) uniform utexture2DMS pass_multisampled_uint_images[16];
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int SAMPLES = 4;
layout(constant_id = 1) const uint CHANNELS = 4;
layout(constant_id = 2) const bool UNSIGNED = false;  // else float, normalised or depth

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  uint at = (p.y * pc.size_px.x + p.x) * uint(SAMPLES) * CHANNELS;
  for (int s = 0; s < SAMPLES; ++s) {
    uvec4 words;
    if (UNSIGNED)
      words = texelFetch(pass_multisampled_uint_images[0], ivec2(p), s);
    else
      words = floatBitsToUint(texelFetch(pass_multisampled_images[0], ivec2(p), s));
    for (uint c = 0; c < CHANNELS; ++c) HashWordsRef(pc.words).w[at++] = words[c];
  }
}
