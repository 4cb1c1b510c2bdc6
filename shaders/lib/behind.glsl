#pragma once
// Of a blended fragment's samples some alone, by the nearest surface that lets light through. The lowest 8 bits of
// pc.own are the place of its depth, or of what is opaque where that is nearer. BEHIND (the samples of a pixel) leaves
// the samples behind it; with BESIDE also those that it does not cover (1: 8 bits up is the place of the opaque depth;
// 0: nothing is opaque). BEFORE leaves all but those behind. Needs lib/bindless.glsl.
#include "lib/occlusion_points.glsl"
#ifdef BEFORE
#define PART_SAMPLES BEFORE
#else
#define PART_SAMPLES BEHIND
#endif

float part_depth(uint place, ivec2 pixel, int number) {
  const uint image = pc.own >> (8u * place) & 0xffu;
#if PART_SAMPLES > 1
  return texelFetch(pass_multisampled_images[image], pixel, number).r;
#else
  return texelFetch(pass_images[image], pixel, 0).r;
#endif
}
bool is_in_part(ivec2 pixel, int number, float z) {
  const float there = part_depth(0u, pixel, number);
#ifdef BEFORE
  return !(z < there);
#elif defined(BESIDE)
  return z < there || there == (BESIDE == 1 ? part_depth(1u, pixel, number) : 0.0);
#else
  return z < there;
#endif
}

// Without discarding: neighbours still want this fragment's derivatives.
void keep_part() {
  const vec2 slope = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z));
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  int left = gl_SampleMaskIn[0];
#if PART_SAMPLES > 1
  for (int i = 0; i < PART_SAMPLES; ++i) {
    const float z = gl_FragCoord.z + dot(slope, sample_place_px(PART_SAMPLES, uint(i)) - 0.5);
    if (!is_in_part(pixel, i, z)) left &= ~(1 << i);
  }
#else
  if (!is_in_part(pixel, 0, gl_FragCoord.z)) left = 0;
#endif
  gl_SampleMask[0] = left;
}
