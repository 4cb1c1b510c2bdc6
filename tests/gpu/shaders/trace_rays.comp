#version 460
// Rays of a list through the frame's trees.
#include "shared/trace.h"
struct TestRay {
  vec3 origin;
  float t_min;
  vec3 direction;
  float t_max;
};
struct TestHit {
  float t, u, v;
  uint item, primitive, back, found, any;
  vec3 position, normal;
  float error_m;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RaysRef { TestRay r[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer HitsRef { TestHit h[]; };
layout(push_constant, scalar) uniform Push {
  uint64_t trees, rays, hits;
  uint count, mode;
} push;
layout(constant_id = 0) const int STACK = 1;
#define TRACE_ADDRESS push.trees
#define TRACE_STACK STACK
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/trace.glsl"
layout(local_size_x = 64) in;
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  const TestRay r = RaysRef(push.rays).r[i];
  TraceHit hit;
  TestHit out_hit;
  const TraceRay ray = TraceRay(r.origin, r.t_min, r.direction, r.t_max);
  out_hit.any = trace(ray, push.mode | TRACE_ANY, TRACE_NOTHING, hit) ? 1u : 0u;
  const bool found = trace(ray, push.mode, TRACE_NOTHING, hit);
  out_hit.found = found ? 1u : 0u;
  out_hit.t = found ? hit.t : 0.0;
  out_hit.u = found ? hit.u : 0.0;
  out_hit.v = found ? hit.v : 0.0;
  out_hit.item = found ? hit.item : 0u;
  out_hit.primitive = found ? hit.primitive : 0u;
  out_hit.back = found ? hit.back : 0u;
  out_hit.position = out_hit.normal = vec3(0.0);
  out_hit.error_m = 0.0;
  if (found) {
    const TracePoint p = trace_point(hit);
    out_hit.position = p.position;
    out_hit.normal = p.normal;
    out_hit.error_m = p.error_m;
  }
  HitsRef(push.hits).h[i] = out_hit;
}
