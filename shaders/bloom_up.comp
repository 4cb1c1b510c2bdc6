#version 460
// A level of the way up: the coarser level through a tent, and this level of the way down, each by its weight.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomUpPush pc; };
#include "lib/bindless.glsl"
#include "lib/bloom.glsl"
#include "lib/bloom_tent.glsl"
layout(local_size_x = bloom_tile, local_size_y = bloom_tile) in;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  precise vec3 sum = bloom_tent(pc.coarse, ivec2(p)) * pc.coarse_weight;
  sum += pc.fine_weight * texelFetch(pass_images[pc.fine], ivec2(p), 0).rgb;
  imageStore(storage_images[pc.target], ivec2(p), vec4(sum, 1.0));
}
