#version 460
// A level of the depth pyramid: the farthest depth of four texels, or of all samples of four pixels. What lies outside
// of the source is nearest, so that it hides nothing and shows nothing.
#include "shared/cull.h"
layout(push_constant, scalar) uniform Push { DepthPyramidPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/frame_depth.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(constant_id = 0) const int SAMPLES = 0;  // of the frame's depth; 0: the source is the finer level

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  float farthest = 1.0;
  for (int i = 0; i < 4; ++i) {
    const ivec2 q = 2 * ivec2(p) + ivec2(i & 1, i >> 1);
    if (any(greaterThanEqual(q, ivec2(pc.source_px)))) continue;
    if (SAMPLES == 0) farthest = min(farthest, texelFetch(pass_images[pc.depth], q, 0).r);
    for (int s = 0; s < SAMPLES; ++s) farthest = min(farthest, frame_depth(q, s, SAMPLES));
  }
  imageStore(storage_images[pc.target], ivec2(p), vec4(farthest));
}
