#version 460
// One level of the pyramid: 13 bilinear taps, five overlapping boxes of 2x2 taps, the middle one by a half and the
// others by an eighth (Jimenez 2014). The first level may weigh each box by 1/(1 + its luminance) (Karis 2013), which
// holds single bright pixels down.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomDownPush pc; };
#include "lib/bindless.glsl"
#include "lib/bloom.glsl"
layout(local_size_x = bloom_tile, local_size_y = bloom_tile) in;
layout(constant_id = 0) const int IS_FIRST = 0;
layout(constant_id = 1) const int KARIS = 0;

// What a group's taps reach of the level before, clamped to the edge: two texels beyond its own on each side.
const int reach = 2 * int(bloom_tile) + 4;
shared vec3 texels[reach * reach];

// The mean of four texels round their corner, a place in the group's window.
vec3 tap(ivec2 corner) {
  const int at = corner.x + reach * corner.y;
  precise vec3 sum = texels[at] * 0.25;
  sum += texels[at + 1] * 0.25;
  sum += texels[at + reach] * 0.25;
  sum += texels[at + reach + 1] * 0.25;
  return sum;
}

void main() {
  const ivec2 window = 2 * int(bloom_tile) * ivec2(gl_WorkGroupID.xy) - 2;
  for (int i = int(gl_LocalInvocationIndex); i < reach * reach; i += int(bloom_tile * bloom_tile)) {
    const ivec2 place = ivec2(i % reach, i / reach), at = window + place;
    vec3 c = texelFetch(pass_images[pc.source], clamp(at, ivec2(0), ivec2(pc.source_px) - 1), 0).rgb;
    if (IS_FIRST != 0) {
      // The picture itself: each texel is cleaned and cut before it is weighed, and counted by the group that owns it.
      const bool owns = all(greaterThanEqual(place, ivec2(2))) && all(lessThan(place, ivec2(reach - 2))) &&
                        all(lessThan(at, ivec2(pc.source_px)));
      if (owns && (any(isnan(c)) || any(isinf(c)))) atomicAdd(BloomReportRef(pc.report).r.nonfinite, 1u);
      c = bloom_bright(c, pc.threshold, pc.knee);
    }
    texels[i] = c;
  }
  barrier();
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  // Always the corner of four texels: at other ratios than 2 the taps leave texels out.
  const ivec2 middle = 2 * ivec2(gl_LocalInvocationID.xy) + 2;
  vec3 inner[4], outer[9];
  for (int i = 0; i < 4; ++i) inner[i] = tap(middle + ivec2(i & 1, i >> 1) * 2 - 1);
  for (int i = 0; i < 9; ++i) outer[i] = tap(middle + 2 * (ivec2(i % 3, i / 3) - 1));
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
