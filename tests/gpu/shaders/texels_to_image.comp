#version 460
// Stores the colours of a buffer, row after row, in an image.
#include "shared/types.h"
#include "lib/bindless.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Texels { vec4 t[]; };
layout(push_constant, scalar) uniform Push { uint64_t source; uint image, width, height; } push;
void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.width || at.y >= push.height) return;
  imageStore(storage_images[push.image], ivec2(at), Texels(push.source).t[at.y * push.width + at.x]);
}
