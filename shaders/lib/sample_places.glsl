#pragma once
// Where the samples of a pixel lie in it: Vulkan's standard places, in pixels from its corner.
vec2 sample_place_px(int samples, uint s) {
  const vec2 at2[2] = vec2[](vec2(0.75), vec2(0.25));
  const vec2 at4[4] = vec2[](vec2(0.375, 0.125), vec2(0.875, 0.375), vec2(0.125, 0.625), vec2(0.625, 0.875));
  const vec2 at8[8] = vec2[](vec2(0.5625, 0.3125), vec2(0.4375, 0.6875), vec2(0.8125, 0.5625), vec2(0.3125, 0.1875),
                             vec2(0.1875, 0.8125), vec2(0.0625, 0.4375), vec2(0.6875, 0.9375), vec2(0.9375, 0.0625));
  return samples == 2 ? at2[s] : samples == 4 ? at4[s] : samples == 8 ? at8[s] : vec2(0.5);
}
