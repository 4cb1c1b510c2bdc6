#version 460
// What the camera's ray through each pixel's middle costs in the trees.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { TraversalHeatPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/axes.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;
layout(constant_id = 20) const int RAY_STACK = 1;
#include "lib/view_ray.glsl"
#define TRACE_ADDRESS pc.trees
#define TRACE_STACK RAY_STACK
#define TRACE_COUNTS
#include "lib/trace.glsl"

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  const ViewRay along = view_ray(vec2(pixel) + 0.5);
  TraceRay ray = TraceRay(along.origin, 0.0, along.direction, TRACE_FAR);
  TraceHit passed = TRACE_NOTHING, hit;
  uint mode = 0u;
  const TraceScene s = TraceSceneRef(pc.trees).s;
  while (trace(ray, mode, passed, hit)) {
    const TraceItem item = trace_item(s, hit.item);
    const bool faces = hit.back == 0u ||
        (MaterialsRef(frame.materials).m[item.material].flags & material_double_sided) != 0u;
    if (faces && (item.flags & trace_blended) == 0u) break;
    passed = hit;
    ray.t_min = hit.t;
    mode = TRACE_PASSED;
  }
  const float cost = 0.25 * float(trace_nodes) + float(trace_triangles);
  imageStore(storage_images[pc.target], ivec2(pixel), vec4(cost));
}
