#version 460
// The first level of the pyramid that reflections look up: the light of surfaces, without that of the fog before them,
// and 1; 0 where there is no surface and in the border.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsColorPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int HAS_FOG = 0;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, uvec2(imageSize(storage_images[pc.target]))))) return;
  vec4 light = vec4(0.0);
  if (all(lessThan(p, pc.size_px)) && texelFetch(pass_images[pc.z], ivec2(p), 0).r > 0.0) {
    light = vec4(texelFetch(pass_images[pc.picture], ivec2(p), 0).rgb, 1.0);
    if (HAS_FOG != 0) light.rgb = max(light.rgb - texelFetch(pass_images[pc.fog], ivec2(p), 0).rgb, vec3(0.0));
  }
  imageStore(storage_images[pc.target], ivec2(p), light);
}
