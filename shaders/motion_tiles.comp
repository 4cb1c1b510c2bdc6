#version 460
// The longest motion in each tile, or in a tile and its neighbours (src/passes/post/motion_blur.h).
#include "shared/motion_blur.h"
layout(push_constant, scalar) uniform Push { MotionTilesPush pc; };
#include "lib/bindless.glsl"
#include "lib/motion_blur.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int NEIGHBOURS = 0;

void main() {
  const uvec2 tile = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(tile, pc.tiles))) return;
  vec2 longest = vec2(0.0);
  if (NEIGHBOURS != 0) {
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const ivec2 other = clamp(ivec2(tile) + ivec2(x, y), ivec2(0), ivec2(pc.tiles) - 1);
        const vec2 motion = texelFetch(pass_images[pc.source], other, 0).xy;
        // A diagonal neighbour matters where its motion points here.
        const bool points_here = x == 0 || y == 0 || motion.x * float(x) * motion.y * float(y) > 0.0;
        if (points_here && dot(motion, motion) > dot(longest, longest)) longest = motion;
      }
  } else {
    const uvec2 end = min((tile + 1u) * pc.side, pc.size_px);
    for (uint y = tile.y * pc.side; y < end.y; ++y)
      for (uint x = tile.x * pc.side; x < end.x; ++x) {
        const vec2 motion = motion_px(texelFetch(pass_images[pc.source], ivec2(x, y), 0).xy, pc.share, float(pc.side));
        if (dot(motion, motion) > dot(longest, longest)) longest = motion;
      }
  }
  imageStore(storage_images[pc.target], ivec2(tile), vec4(longest, 0.0, 0.0));
}
