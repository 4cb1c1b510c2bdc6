#version 460
// The sum of a picture's frames as an image.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SubframesMeanPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(buffer_reference, scalar) readonly buffer SumRef { vec4 texel[]; };

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  imageStore(storage_images[pc.target], ivec2(p), SumRef(pc.sum).texel[p.y * pc.size_px.x + p.x]);
}
