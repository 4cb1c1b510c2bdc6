#version 460
// The mean over 5 by 5 texels whose outer rows count half, so that each value of the pattern of 4 by 4 counts alike;
// texels off the tangent plane count less.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionDenoisePush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SHAPE = 257;

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  const vec2 middle = texelFetch(pass_images[pc.open], texel, 0).xy;
  float open = 1.0;
  if (middle.y > 0.0) {
    const vec3 p = occlusion_point(texel, middle.y, SHAPE, pc.subsample_ndc);
    const vec3 n = unpack_normal(texelFetch(pass_uint_images[pc.normals], texel, 0).r);
    float sum = 0.0, weights = 0.0;
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const ivec2 other = texel + ivec2(x, y);
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) continue;
        const vec2 o = texelFetch(pass_images[pc.open], other, 0).xy;
        if (!(o.y > 0.0)) continue;
        float w = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
        w *= occlusion_likeness(occlusion_point(other, o.y, SHAPE, pc.subsample_ndc), p, n);
        if (!(w > 0.0)) continue;
        sum += w * o.x;
        weights += w;
      }
    open = weights > 0.0 ? clamp(sum / weights, 0.0, 1.0) : middle.x;
  }
  imageStore(storage_images[pc.smooth_open], texel, vec4(open, middle.y, 0.0, 0.0));
}
