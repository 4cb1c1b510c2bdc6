#version 460
// One direction of a Gaussian over coarse texels; with depth_fraction less of those at other depths (Tomasi and
// Manduchi, "Bilateral Filtering for Gray and Color Images", 1998, by depth).
#include "shared/volumetric.h"
layout(push_constant, scalar) uniform Push { VolumetricFilterPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, pc.texels))) return;
  const ivec2 axis = pc.down != 0u ? ivec2(0, 1) : ivec2(1, 0);
  const float metres = texelFetch(pass_images[pc.source], p, 0).a;
  vec3 sum = vec3(0.0);
  float all = 0.0;
  for (int i = -int(pc.radius); i <= int(pc.radius); ++i) {
    const ivec2 q = clamp(p + i * axis, ivec2(0), ivec2(pc.texels) - 1);
    const vec4 texel = texelFetch(pass_images[pc.source], q, 0);
    const float off = float(i) / pc.deviation;
    float weight = exp(-0.5 * off * off);
    if (pc.depth_fraction > 0.0) {
      const float other = (texel.a - metres) / max(max(texel.a, metres), 1e-30) / pc.depth_fraction;
      weight *= exp(-min(0.5 * other * other, 80.0));
    }
    sum += weight * texel.rgb;
    all += weight;
  }
  imageStore(storage_images[pc.target], p, vec4(sum / all, metres));
}
