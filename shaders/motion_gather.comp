#version 460
// Gathers along the longest motion near each pixel (McGuire et al. 2012; src/passes/post/motion_blur.h).
#include "shared/motion_blur.h"
layout(push_constant, scalar) uniform Push { MotionGatherPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/motion_blur.glsl"
layout(constant_id = 0) const int DEPTH_SAMPLES = 0;
#include "lib/coarse_depth.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

const float SAME_SURFACE = 0.02;  // of a depth

uint hashed(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

// How far something at depth a lies before something at depth b: 1 before it or beside it, 0 behind it.
float before(float a, float b) { return clamp(1.0 - (a - b) / (SAME_SURFACE * min(a, b)), 0.0, 1.0); }
// Whether motion of that length reaches so far, and whether it covers it evenly.
float cone(float distance_px, float length_px) { return clamp(1.0 - distance_px / length_px, 0.0, 1.0); }
float cylinder(float distance_px, float length_px) {
  return 1.0 - smoothstep(0.95 * length_px, 1.05 * length_px, distance_px);
}

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  const ivec2 here = ivec2(p);
  const vec4 own = texelFetch(pass_images[pc.color], here, 0);
  const float most = float(pc.side);
  const vec2 along = texelFetch(pass_images[pc.neighbours], here / int(pc.side), 0).xy;
  if (dot(along, along) <= 0.25) {
    imageStore(storage_images[pc.target], here, own);
    return;
  }
  const float least = 0.5;  // pixels: shorter motion is that of what stands
  const float own_m = coarse_metres(here);
  const float own_px =
      max(length(motion_px(texelFetch(pass_images[pc.motion], here, 0).xy, pc.share, most)), least);
  float weight = 1.0 / own_px;
  precise vec4 sum = own * weight;
  const float turn = float(hashed(p.x ^ hashed(p.y ^ hashed(pc.seed))) >> 8) * exp2(-24.0);
  for (uint i = 0u; i < pc.samples; ++i) {
    const float t = 2.0 * (float(i) + turn) / float(pc.samples) - 1.0;
    const ivec2 there = ivec2(floor(vec2(p) + 0.5 + along * t));
    if (there == here || any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(pc.size_px)))) continue;
    const float away = distance(vec2(there), vec2(here)), other_m = coarse_metres(there);
    const float other_px =
        max(length(motion_px(texelFetch(pass_images[pc.motion], there, 0).xy, pc.share, most)), least);
    // What moves there comes over this pixel; what moves here lets the other be seen; both blur into each other.
    const float w = before(other_m, own_m) * cone(away, other_px) + before(own_m, other_m) * cone(away, own_px)
        + 2.0 * cylinder(away, other_px) * cylinder(away, own_px);
    weight += w;
    sum += texelFetch(pass_images[pc.color], there, 0) * w;
  }
  imageStore(storage_images[pc.target], here, sum / weight);
}
