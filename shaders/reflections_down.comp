#version 460
// A level of the pyramid: the mean of four texels, light and the fraction that surfaces cover. precise: a sum that is
// divided afterwards, as compilers like to write it, is beyond floats for light above a quarter of their largest.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsDownPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  const ivec2 q = 2 * ivec2(p);
  precise vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) sum += 0.25 * texelFetch(pass_images[pc.source], q + ivec2(i & 1, i >> 1), 0);
  imageStore(storage_images[pc.target], ivec2(p), sum);
}
