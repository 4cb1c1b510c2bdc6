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

// The texels that a thread's four targets are made of: two beyond their own on each side.
const int reach = 8;
vec3 texels[reach * reach];

// The mean of four texels round their corner, a place in the window.
vec3 tap(int x, int y) {
  const int at = x + reach * y;
  precise vec3 sum = texels[at] * 0.25;
  sum += texels[at + 1] * 0.25;
  sum += texels[at + reach] * 0.25;
  sum += texels[at + reach + 1] * 0.25;
  return sum;
}

// A thread makes four texels, which share taps.
void main() {
  const ivec2 target = 2 * ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(target, ivec2(pc.target_px)))) return;
  const ivec2 window = 2 * target - 2;
  uint nonfinite = 0u;
  for (int y = 0; y < reach; ++y)
    for (int x = 0; x < reach; ++x) {
      const ivec2 at = window + ivec2(x, y);
      vec3 c = texelFetch(pass_images[pc.source], clamp(at, ivec2(0), ivec2(pc.source_px) - 1), 0).rgb;
      if (IS_FIRST != 0) {
        // The picture itself: each texel is cleaned and cut before it is weighed, and counted by the thread that owns
        // it.
        const bool owns = x >= 2 && x < reach - 2 && y >= 2 && y < reach - 2 && all(lessThan(at, ivec2(pc.source_px)));
        nonfinite += uint(owns && (any(isnan(c)) || any(isinf(c))));
        c = bloom_bright(c, pc.threshold, pc.knee);
      }
      texels[x + reach * y] = c;
    }
  if (IS_FIRST != 0 && nonfinite != 0u) atomicAdd(BloomReportRef(pc.report).r.nonfinite, nonfinite);
  // Always the corner of four texels: at other ratios than 2 the taps leave texels out.
  vec3 inner[9], outer[16];
  for (int i = 0; i < 9; ++i) inner[i] = tap(1 + 2 * (i % 3), 1 + 2 * (i / 3));
  for (int i = 0; i < 16; ++i) outer[i] = tap(2 * (i & 3), 2 * (i >> 2));
  for (int t = 0; t < 4; ++t) {
    const int in0 = (t & 1) + 3 * (t >> 1), out0 = (t & 1) + 4 * (t >> 1);  // the upper left taps
    // precise: each is weighed before it is added, for sums of the brightest lie beyond floats.
    precise vec3 boxes[5];
    boxes[0] = inner[in0] * 0.25 + inner[in0 + 1] * 0.25 + inner[in0 + 3] * 0.25 + inner[in0 + 4] * 0.25;
    for (int i = 0; i < 4; ++i) {
      const int o = out0 + (i & 1) + 4 * (i >> 1);
      boxes[i + 1] = outer[o] * 0.25 + outer[o + 1] * 0.25 + outer[o + 4] * 0.25 + outer[o + 5] * 0.25;
    }
    precise vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 5; ++i) {
      float w = i == 0 ? 0.5 : 0.125;
      if (IS_FIRST != 0 && KARIS != 0) w /= 1.0 + bloom_luminance(boxes[i]);
      sum += boxes[i] * w;
      weights += w;
    }
    const ivec2 p = target + ivec2(t & 1, t >> 1);
    if (all(lessThan(p, ivec2(pc.target_px)))) imageStore(storage_images[pc.target], p, vec4(sum / weights, 1.0));
  }
}
