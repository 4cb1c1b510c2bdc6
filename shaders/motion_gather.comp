#version 460
// Gathers along the longest motion near each pixel (src/passes/post/motion_blur.h).
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
  const float own_px = length(motion_px(texelFetch(pass_images[pc.motion], here, 0).xy, pc.share, most));
  const float turn = float(hashed(p.x ^ hashed(p.y ^ hashed(pc.seed))) >> 8) * exp2(-24.0);
  const float step_px = 2.0 * length(along) / float(pc.samples);
  // What passes before the surface of this pixel, that surface, and what is behind it: of the first two the part of the
  // time for which they cover the pixel.
  precise vec4 nearer = vec4(0.0), same = vec4(0.0), behind = vec4(0.0);
  float nearer_part = 0.0, same_part = 0.0, behind_count = 0.0;
  for (uint i = 0u; i < pc.samples; ++i) {
    const float t = 2.0 * (float(i) + turn) / float(pc.samples) - 1.0;
    const ivec2 there = ivec2(floor(vec2(p) + 0.5 + along * t));
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, ivec2(pc.size_px)))) continue;
    const vec4 color = texelFetch(pass_images[pc.color], there, 0);
    const float other_m = coarse_metres(there), ahead = (own_m - other_m) / min(own_m, other_m);
    if (ahead < -SAME_SURFACE) {
      behind += color;
      behind_count += 1.0;
      continue;
    }
    // It is spread evenly over its way, and reaches this pixel if that is long enough.
    const float other_px =
        max(length(motion_px(texelFetch(pass_images[pc.motion], there, 0).xy, pc.share, most)), least);
    const float away = distance(vec2(there), vec2(here));
    const float part = step_px / (2.0 * other_px) * clamp(other_px - away + 0.5, 0.0, 1.0);
    if (ahead > SAME_SURFACE) {
      nearer += color * part;
      nearer_part += part;
    } else {
      same += color * part;
      same_part += part;
    }
  }
  if (own_px <= least) {
    same = own;
    same_part = 1.0;
  }
  if (same_part > 1.0 || (behind_count == 0.0 && same_part > 0.0)) same /= same_part;
  if (behind_count > 0.0 && same_part < 1.0) same += behind * ((1.0 - same_part) / behind_count);
  if (same_part == 0.0 && behind_count == 0.0) same = own;
  if (nearer_part > 1.0) nearer /= nearer_part;
  const vec4 sum = nearer + same * (1.0 - min(nearer_part, 1.0));
  imageStore(storage_images[pc.target], here, sum);
}
