#version 460
// The picture darker towards its corners.
#include "shared/types.h"
#include "lib/bindless.glsl"
layout(push_constant, scalar) uniform Push {
  uint source, color, left, width_px, height_px;
  float strength, power;
} pc;
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy), size = ivec2(pc.width_px, pc.height_px);
  if (any(greaterThanEqual(p, size))) return;
  const vec2 from_middle = (vec2(p) + 0.5) / vec2(size) * 2 - 1;
  const float left = 1 - pc.strength * pow(length(from_middle) / sqrt(2.0), pc.power);
  const vec4 linear = texelFetch(pass_images[pc.source], p, 0);
  imageStore(storage_images[pc.color], p, vec4(linear.rgb * left, linear.a));
  imageStore(storage_images[pc.left], p, vec4(left, 0, 0, 1));
}
