#version 460
#include "lib/bindless.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Push { uint depth, image, width, height; } push;
void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.width || at.y >= push.height) return;
  imageStore(storage_images[push.image], at, vec4(texelFetch(pass_images[push.depth], at, 0).x));
}
