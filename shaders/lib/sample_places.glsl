#pragma once
// Where the samples of a pixel lie in it: Vulkan's standard places, in pixels from its corner. In sixteenths, four bits
// a sample: an array of constants that is asked for by a variable is memory, which a CPU gathers lane by lane.
vec2 sample_place_px(int samples, uint s) {
  const uvec2 places = samples == 2 ? uvec2(0x4cu, 0x4cu)
      : samples == 4                ? uvec2(0xa2e6u, 0xea62u)
      : samples == 8                ? uvec2(0xfb135d79u, 0x1f7d39b5u)
                                    : uvec2(0x88888888u);
  return vec2(places >> (4u * s) & 15u) * (1.0 / 16.0);
}
