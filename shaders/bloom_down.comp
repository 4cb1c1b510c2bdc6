#version 460
// One level of the pyramid: 13 bilinear taps, five overlapping boxes of 2x2 taps, the middle one by a half and the
// others by an eighth (Jimenez 2014). The first level may weigh each box by 1/(1 + its luminance) (Karis 2013), which
// holds single bright pixels down.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomDownPush pc; };
#include "lib/image_kinds.glsl"
#include "lib/bloom.glsl"
layout(local_size_x = bloom_group, local_size_y = 1) in;
layout(constant_id = 0) const int IS_FIRST = 0;
layout(constant_id = 1) const int KARIS = 0;

// The mean of the texels round a point between them, or near it, by bilinear weights; clamped to the edge.
vec3 tap(vec2 at_px) {
  if (IS_FIRST == 0)
    return texture(sampler2D(pass_images[pc.source], graph_samplers[SAMPLER_LINEAR_CLAMP]), at_px / vec2(pc.source_px))
        .rgb;
  // The picture itself: each texel is cleaned and cut before it is weighed.
  const vec2 corner = floor(at_px - 0.5);
  const vec2 f = at_px - 0.5 - corner;
  precise vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    const ivec2 o = ivec2(i & 1, i >> 1);
    const ivec2 p = clamp(ivec2(corner) + o, ivec2(0), ivec2(pc.source_px) - 1);
    const vec2 w = mix(1.0 - f, f, vec2(o));
    sum += bloom_bright(texelFetch(pass_images[pc.source], p, 0).rgb, pc.threshold, pc.knee) * (w.x * w.y);
  }
  return sum;
}

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (IS_FIRST != 0 && all(lessThan(p, pc.target_px))) {
    // Every texel of the picture is counted once, by the texel of this level that it belongs to.
    for (uint i = 0u; i < 4u; ++i) {
      const uvec2 from = 2u * p + uvec2(i & 1u, i >> 1);
      if (any(greaterThanEqual(from, pc.source_px))) continue;
      const vec3 c = texelFetch(pass_images[pc.source], ivec2(from), 0).rgb;
      if (any(isnan(c)) || any(isinf(c))) atomicAdd(BloomReportRef(pc.report).r.nonfinite, 1u);
    }
  }
  if (any(greaterThanEqual(p, pc.target_px))) return;
  // Always the corner of four texels: at other ratios than 2 the taps leave texels out.
  const vec2 middle = 2.0 * vec2(p) + 1.0;
  vec3 inner[4], outer[9];
  for (int i = 0; i < 4; ++i) inner[i] = tap(middle + vec2(i & 1, i >> 1) * 2.0 - 1.0);
  for (int i = 0; i < 9; ++i) outer[i] = tap(middle + 2.0 * (vec2(i % 3, i / 3) - 1.0));
  // precise: each is weighed before it is added, for sums of the brightest lie beyond floats.
  precise vec3 boxes[5];
  boxes[0] = inner[0] * 0.25 + inner[1] * 0.25 + inner[2] * 0.25 + inner[3] * 0.25;
  for (int i = 0; i < 4; ++i) {
    const int first = (i & 1) + 3 * (i >> 1);  // the box's upper left tap
    boxes[i + 1] = outer[first] * 0.25 + outer[first + 1] * 0.25 + outer[first + 3] * 0.25 + outer[first + 4] * 0.25;
  }
  precise vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int i = 0; i < 5; ++i) {
    float w = i == 0 ? 0.5 : 0.125;
    if (IS_FIRST != 0 && KARIS != 0) w /= 1.0 + bloom_luminance(boxes[i]);
    sum += boxes[i] * w;
    weights += w;
  }
  imageStore(storage_images[pc.target], ivec2(p), vec4(sum / weights, 1.0));
}
