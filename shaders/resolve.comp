#version 460
// The mean of a pixel's samples.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ResolvePush pc; };
#include "shared/types.h"
#include "lib/bindless.glsl"
#include "lib/mean_of_samples.glsl"
// Rows: where a row is a multiple of 4096 bytes, the samples of 8 by 8 pixels fall into the same sets of a CPU's cache.
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SAMPLES = 4;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  imageStore(storage_images[pc.target], ivec2(p), mean_of_samples(pc.source, ivec2(p), SAMPLES));
}
