#version 460
// Onto a picture of one sample, added: what reflections of the scene put in place of the sky's.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsOverWholePush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/reflections_over.glsl"
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  vec3 gained, taken;
  find_reflected(ivec2(pixel), gained, taken);
  const vec4 radiance = imageLoad(storage_read_images[pc.color], ivec2(pixel));
  imageStore(storage_read_images[pc.color], ivec2(pixel), radiance + vec4(gained - taken, 0.0));
}
