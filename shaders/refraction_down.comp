#version 460
// A level of what is seen through glass: the mean over the texel's area of the level before, whose texels count by the
// part of them that lies in it. The first level's source is the picture, of any size.
#include "shared/refraction.h"
layout(push_constant, scalar) uniform Push { RefractionDownPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  const vec2 size = vec2(pc.source_px) / vec2(pc.target_px);  // of a texel, in those of the source: at most 2
  const vec2 low = vec2(p) * size, high = low + size;
  const ivec2 first = ivec2(low), last = min(ivec2(ceil(high)), ivec2(pc.source_px)) - 1;
  // Each by its fraction before it is added: a sum of the brightest lies beyond floats where their mean does not.
  precise vec4 sum = vec4(0.0);
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      const vec2 shared_px = max(min(high, vec2(x, y) + 1.0) - max(low, vec2(x, y)), vec2(0.0)) / size;
      sum += texelFetch(pass_images[pc.source], ivec2(x, y), 0) * (shared_px.x * shared_px.y);
    }
  }
  imageStore(storage_images[pc.target], ivec2(p), sum);
}
