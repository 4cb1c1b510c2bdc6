#version 460
// One round of the filter of texels by rays: the mean over 5 by 5 texels, `stride` apart, whose outer rows count half,
// so that the first round takes each texel of the squares that share a sequence alike (occlusion_rays.comp). Texels off
// the tangent plane and those that face elsewhere count less (Dammertz, Sewtz, Hanika, Lensch, "Edge-Avoiding A-Trous
// Wavelet Transform for fast Global Illumination Filtering", 2010). Later rounds, whose texels are means of all
// directions, also know contacts: a texel that is more or less open than noise explains counts less.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionFilterPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
#include "lib/openness.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SHAPE = 257;

// Variance of fractions within which a texel counts as alike, before it is divided by the noise's fall.
const float LEAST_VARIANCE = 0.1;

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  const vec4 middle = texelFetch(pass_images[pc.open], texel, 0);
  vec2 open = vec2(0.0);    // of the fraction, and of the mirror direction
  vec2 bright = vec2(0.0);  // of all the sky, and of what is open
  float weights = 0.0;
  if (middle.y > 0.0) {
    const vec3 p = occlusion_point(texel, middle.y, SHAPE, pc.subsample_ndc);
    const vec3 n = unpack_normal(texelFetch(pass_uint_images[pc.normals], texel, 0).r);
    const float own = unpack_open(middle.x).x;
    const float unlike = pc.sharpness / max(own * (1.0 - own), LEAST_VARIANCE);
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const ivec2 other = texel + pc.stride * ivec2(x, y);
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) continue;
        const vec4 o = texelFetch(pass_images[pc.open], other, 0);
        if (!(o.y > 0.0)) continue;
        const vec3 q = occlusion_point(other, o.y, SHAPE, pc.subsample_ndc);
        const vec3 facing = unpack_normal(texelFetch(pass_uint_images[pc.normals], other, 0).r);
        const vec2 there = unpack_open(o.x);
        const float off = there.x - own;
        const float w = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0) * occlusion_likeness(q, p, n) *
            exp2(OCCLUSION_TURN * (dot(n, facing) - 1.0) - unlike * off * off);
        if (!(w > 0.0)) continue;
        open += w * there;
        bright += w * o.zw;
        weights += w;
      }
  }
  const bool known = weights > 0.0;
  imageStore(storage_images[pc.smooth_open], texel,
      vec4(known ? pack_open(open.x / weights, open.y / weights) : middle.x, middle.y,
          known ? bright / weights : middle.zw));
}
