#version 460
#include "lib/bindless.glsl"
// Writes (value, x, y, 1) to each texel of an image.
layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Push {
  uint image, width, height;
  float value;
} push;
void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.width || at.y >= push.height) return;
  imageStore(storage_images[push.image], ivec2(at), vec4(push.value, vec2(at), 1.0));
}
