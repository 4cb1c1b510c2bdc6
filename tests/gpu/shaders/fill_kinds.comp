#version 460
#include "lib/image_kinds.glsl"
// Writes (base, x, y, z) to each texel of an array or a 3D image, or adds base to each texel of a 2D one.
layout(local_size_x = 4, local_size_y = 4) in;
layout(constant_id = 0) const int KIND = 0;
layout(push_constant, scalar) uniform Push { uint target; float base; uvec3 size; } push;
void main() {
  const ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(uvec3(at), push.size))) return;
  if (KIND == 0) {
    const vec4 old = imageLoad(storage_read_images[push.target], at.xy);
    imageStore(storage_read_images[push.target], at.xy, old + vec4(push.base));
  }
  const vec4 value = vec4(push.base, vec3(at));
  if (KIND == 1) imageStore(storage_array_images[push.target], at, value);
  if (KIND == 4) imageStore(storage_volume_images[push.target], at, value);
}
