#version 460
#include "lib/bindless.glsl"
// One mip from the mip before: the mean of 2x2 texels.
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Push { uint source, target, width, height; } push;
void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.width || at.y >= push.height) return;
  vec4 sum = vec4(0);
  for (int i = 0; i < 4; ++i) sum += texelFetch(pass_images[push.source], 2 * at + ivec2(i & 1, i >> 1), 0);
  imageStore(storage_images[push.target], at, sum * 0.25);
}
