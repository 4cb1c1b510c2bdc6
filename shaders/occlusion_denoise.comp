#version 460
// The mean over 5 by 5 texels whose outer rows count half, so that each value of the pattern of 4 by 4 counts alike;
// texels off the tangent plane count less, and those farther off than contacts are wide.
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
  const bool is_bent = OCCLUSION_BENT(SHAPE) != 0;
  const vec4 middle = texelFetch(pass_images[pc.open], texel, 0);
  vec2 bent_place = middle.zw;
  float open = 1.0;
  if (middle.y > 0.0) {
    const vec3 p = occlusion_point(texel, middle.y, SHAPE, pc.subsample_ndc);
    const vec3 n = unpack_normal(texelFetch(pass_uint_images[pc.normals], texel, 0).r);
    const float reach_m = pc.reach_m * (pc.by_distance != 0u ? max(-p.z, 1e-30) : 1.0);
    float sum = 0.0, weights = 0.0;
    vec3 bent = vec3(0.0);
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const ivec2 other = texel + ivec2(x, y);
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) continue;
        const vec4 o = texelFetch(pass_images[pc.open], other, 0);
        if (!(o.y > 0.0)) continue;
        float w = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
        const vec3 q = occlusion_point(other, o.y, SHAPE, pc.subsample_ndc), away = (q - p) / reach_m;
        w *= occlusion_likeness(q, p, n) * exp2(-dot(away, away));
        if (!(w > 0.0)) continue;
        sum += w * o.x;
        if (is_bent) bent += w * o.x * normal_at_place(o.zw);
        weights += w;
      }
    if (weights > 0.0) open = sum == weights ? 1.0 : clamp(sum / weights, 0.0, 1.0);  // a device may round x / x
    else open = middle.x;
    if (is_bent && length(bent) > 1e-6) bent_place = place_of_normal(normalize(bent));
  }
  imageStore(storage_images[pc.smooth_open], texel, vec4(open, middle.y, bent_place));
}
