#version 460
// Adds one frame of a picture, by its fraction, to the sum of those before it (passes/post/subframes.h).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { SubframesPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int HAS_COLOR = 0;
layout(buffer_reference, scalar) readonly buffer SumBeforeRef { vec4 texel[]; };
layout(buffer_reference, scalar) writeonly buffer SumRef { vec4 texel[]; };

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  const uint i = p.y * pc.size_px.x + p.x;
  precise vec4 sum = vec4(0.0);
  if (HAS_COLOR != 0) sum = texelFetch(pass_images[pc.source], ivec2(p + pc.first_px), 0) * pc.fraction;
  if (pc.adds != 0u) sum += SumBeforeRef(pc.before).texel[i];
  SumRef(pc.sum).texel[i] = sum;
}
