#version 460
// Keys of a visibility buffer by rays, through the trees or by queries (TRACE_QUERY).
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { TraceKeysPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/axes.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;
layout(constant_id = 20) const int RAY_STACK = 1;
#include "lib/view_ray.glsl"
#define TRACE_ADDRESS pc.trees
#define TRACE_STACK RAY_STACK
#include "lib/trace.glsl"
#include "lib/trace_keys.glsl"

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (all(lessThan(pixel, frame.size_px))) put_keys(pixel);
}
