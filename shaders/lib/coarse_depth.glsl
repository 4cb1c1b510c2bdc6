#pragma once
// Depths of texels that are several pixels wide. A texel's depth is one of its pixels', chosen and never averaged; its
// ray is that pixel's. Needs lib/frame.glsl, lib/image_kinds.glsl, pc.depth or pc.keys and the constant DEPTH_SAMPLES
// (0: nothing is drawn).
#include "lib/frame_depth.glsl"
#include "shared/volumetric.h"

const float COARSE_FAR = 1e18;  // where nothing is drawn

// Metres in front of the camera, of a pixel's first sample.
float coarse_metres(ivec2 pixel) {
  if (DEPTH_SAMPLES == 0) return COARSE_FAR;
  const float d = frame_depth(pixel, 0, DEPTH_SAMPLES);
  if (!(d > 0.0)) return COARSE_FAR;
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return min(m[3][2] / d, COARSE_FAR);
  const vec3 row = vec3(m[0][2], m[1][2], m[2][2]);
  return max((m[3][2] - d) / length(row), 1e-30);
}

// Which of a texel's pixels it follows: the nearest, or the nearest and the farthest by turns.
ivec2 coarse_pixel(uvec2 texel, uint texel_px, uint rule, out float metres) {
  const bool farthest = rule == coarse_checkerboard && ((texel.x + texel.y) & 1u) != 0u;
  ivec2 best = ivec2(texel * texel_px);
  metres = coarse_metres(best);
  for (uint i = 1u; i < texel_px * texel_px; ++i) {
    const ivec2 pixel = ivec2(texel * texel_px + uvec2(i % texel_px, i / texel_px));
    if (any(greaterThanEqual(uvec2(pixel), frame.size_px))) continue;
    const float z = coarse_metres(pixel);
    if (farthest ? z > metres : z < metres) {
      metres = z;
      best = pixel;
    }
  }
  return best;
}

// Normalised device coordinates of a pixel's middle, y down.
vec2 coarse_ndc(ivec2 pixel) { return 2.0 * (vec2(pixel) + 0.5) / vec2(frame.size_px) - 1.0; }
