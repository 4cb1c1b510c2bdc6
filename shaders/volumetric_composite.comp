#version 460
// The picture with the light in its air, at the picture's size.
#include "shared/scene.h"
#include "shared/volumetric.h"
layout(push_constant, scalar) uniform Push { VolumetricCompositePush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
layout(constant_id = 0) const int DEPTH_SAMPLES = 0;
layout(constant_id = 1) const int HAS_LAYER = 0;  // the light is wanted for itself
#include "lib/coarse_depth.glsl"
#include "lib/coarse_light.glsl"
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, pc.size_px))) return;
  const float metres = pc.aware != 0u ? coarse_metres(p) : 0.0;
  const vec3 light = coarse_light(pc.light, vec2(p) + 0.5, pc.texel_px, ivec2(pc.texels), metres, pc.aware != 0u);
  const vec4 color = texelFetch(pass_images[pc.color], p, 0);
  imageStore(storage_images[pc.composed], p, vec4(color.rgb + light, color.a));
  if (HAS_LAYER != 0) imageStore(storage_images[pc.layer], p, vec4(light, 1.0));
}
