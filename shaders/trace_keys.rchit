#version 460
// The nearest triangle that is there for a ray.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { TraceKeysPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#define TRACE_ADDRESS pc.trees
#define TRACE_HIT
#include "lib/trace.glsl"

void main() {
  traced.hit = trace_met();
  traced.found = 1u;
}
