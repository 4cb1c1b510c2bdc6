#version 460
// Radiance to display values.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { TonemapPush pc; };
#include "shared/types.h"
#include "lib/bindless.glsl"
#include "lib/display_value.glsl"
layout(local_size_x = 64, local_size_y = 1) in;  // rows, as in resolve.comp

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  imageStore(storage_images[pc.target], ivec2(p), display_value(p));
}
