#version 460
// A level of the way up: the coarser level through a tent, and this level of the way down, each by its weight.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomUpPush pc; };
#include "lib/bindless.glsl"
#include "lib/bloom.glsl"
#include "lib/bloom_tent.glsl"
layout(local_size_x = bloom_tile, local_size_y = bloom_tile) in;

// A thread makes four texels.
void main() {
  const ivec2 q = ivec2(gl_GlobalInvocationID.xy), first = 2 * q - 1;
  if (any(greaterThanEqual(first, ivec2(pc.target_px)))) return;
  vec3 tents[4];
  bloom_tents(pc.coarse, q, tents);
  for (int i = 0; i < 4; ++i) {
    const ivec2 p = first + ivec2(i & 1, i >> 1);
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(pc.target_px)))) continue;
    precise vec3 sum = tents[i] * pc.coarse_weight;
    sum += pc.fine_weight * texelFetch(pass_images[pc.fine], p, 0).rgb;
    imageStore(storage_images[pc.target], p, vec4(sum, 1.0));
  }
}
