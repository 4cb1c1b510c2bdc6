#version 460
// The mean of a pixel's samples: the unbiased estimate of its radiance under a box filter (TECHNIQUES 3.2).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ResolvePush pc; };
#include "shared/types.h"
#include "lib/bindless.glsl"
// Rows: where a row is a multiple of 4096 bytes, the samples of 8 by 8 pixels fall into the same sets of a CPU's cache.
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SAMPLES = 4;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  precise vec4 sum = vec4(0.0);
  // Each by its share, which for a power of two is exact: the sum of bright samples may be no float where their mean
  // is.
  for (int s = 0; s < SAMPLES; ++s) sum += texelFetch(pass_multisampled_images[pc.source], ivec2(p),
      s) * (1.0 / float(SAMPLES));
  imageStore(storage_images[pc.target], ivec2(p), sum);
}
