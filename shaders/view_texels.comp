#version 460
// Depths of views, layer by layer, into the layers of an image of floats: four texels of a row a thread.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { ViewTexelsPush pc; };
#include "lib/image_kinds.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TexelsRef { vec4 t[]; };

void main() {
  const uvec3 at = gl_GlobalInvocationID;
  if (at.x * 4u >= pc.image_px || at.y >= pc.image_px) return;
  const vec4 depths = TexelsRef(pc.texels).t[((at.z * pc.image_px + at.y) * pc.image_px >> 2u) + at.x];
  for (uint i = 0u; i < 4u; ++i)
    imageStore(storage_array_images[pc.image], ivec3(at.x * 4u + i, at.yz), vec4(depths[i]));
}
