#version 460
// Adds one sample's picture, by its fraction, to the sum of those before it.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SupersamplePush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int ADDS = 0;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  precise vec4 sum = texelFetch(pass_images[pc.source], ivec2(p), 0) * pc.fraction;
  if (ADDS != 0) sum += texelFetch(pass_images[pc.before], ivec2(p), 0);
  imageStore(storage_images[pc.target], ivec2(p), sum);
}
