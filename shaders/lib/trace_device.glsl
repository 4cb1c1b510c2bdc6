// Rays through the device's acceleration structures (VK_KHR_acceleration_structure; gpu/acceleration.h), by a query in
// any shader (TRACE_QUERY) or by a pipeline of rays (TRACE_RAYGEN in its first shader, TRACE_HIT in those of hits). The
// device only names triangles: where the ray meets one is computed by the operations of lib/trace.glsl, from the same
// corners, so that pictures are those of the trees but on edges and at ties. What counts for a ray is asked there too.
// Triangles are opaque to the device where no ray asks anything of them (plan/frame_rays.cpp).
#ifdef TRACE_QUERY
#extension GL_EXT_ray_query : require
#else
#extension GL_EXT_ray_tracing : require
#endif

TraceGeometry trace_geometry(TraceScene s, uint number) {
  return TraceGeometryRef(trace_entry(s.geometries, s.places, 12ul, number)).g;
}
uint trace_place_of(TraceScene s, uint triangle) {
  return TraceUintRef(trace_entry(s.places, s.end, 4ul, triangle)).u;
}

// Where the ray meets a triangle of geometry `number`. h: t, weights and side as the device has them, which stay where
// ours say that the ray passes by.
TraceHit trace_named(TraceScene s, TraceRay ray, uint number, uint primitive, TraceHit h) {
  const TraceGeometry g = trace_geometry(s, number);
  h.item = g.item;
  h.primitive = primitive;
  h.instance = g.instance;
  h.place = trace_place_of(s, g.first_place + primitive);
  vec3 origin = ray.origin, direction = ray.direction;
  const bool entered = g.instance == no_trace || trace_enter(trace_instance(s, g.instance), ray, origin, direction);
  const TraceFrame f = trace_frame(origin, direction);
  const TraceState any = TraceState(-TRACE_FAR, TRACE_FAR, TRACE_NOTHING, false);
  if (entered)
    trace_test(trace_triangle(s, h.place), f, any, h);
  if (g.instance == no_trace && (trace_item(s, g.item).flags & trace_mirrored) != 0u) h.back ^= 1u;
#ifdef RELIEFS
  const TraceItem relief = trace_item(s, g.item);
  // None: a t outside of every ray's limits.
  if ((relief.flags & trace_relief_bit) != 0u &&
      !trace_relief(s, relief, trace_triangle(s, h.place), 1.0 / f.inverse, ray.t_min, ray.t_max, h))
    h.t = -TRACE_FAR;
#endif
  return h;
}

#ifndef TRACE_QUERY
// Between the shaders of a pipeline. The hit on the way there is what was passed.
struct TracePayload {
  TraceHit hit;
  float t_min, t_max;
  uint mode, found;
};
#endif

#ifdef TRACE_HIT
layout(location = 0) rayPayloadInEXT TracePayload traced;
hitAttributeEXT vec2 device_weights;

TraceHit trace_met() {
  TraceHit h = TRACE_NOTHING;
  h.t = gl_HitTEXT;
  h.u = device_weights.x;
  h.v = device_weights.y;
  h.back = gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT ? 1u : 0u;
  const TraceRay ray = TraceRay(gl_WorldRayOriginEXT, traced.t_min, gl_WorldRayDirectionEXT, traced.t_max);
  return trace_named(TraceSceneRef(TRACE_ADDRESS).s, ray, uint(gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT),
      uint(gl_PrimitiveID), h);
}
#else

// A ray that goes on behind a triangle may find its own t on the other side of the device's.
const float TRACE_BEFORE = 1.0 - 1e-6;

// What was passed, and what is near t = 1, is asked of all triangles.
uint trace_flags(uint mode) {
  return ((mode & (TRACE_PASSED | TRACE_LOCATE)) != 0u ? gl_RayFlagsNoOpaqueEXT : gl_RayFlagsNoneEXT) |
      ((mode & TRACE_ANY) != 0u ? gl_RayFlagsTerminateOnFirstHitEXT : gl_RayFlagsNoneEXT);
}
#endif

#ifdef TRACE_QUERY
#define TRACE_QUERIED(query, committed) \
  trace_named(s, ray, uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, committed) + \
      rayQueryGetIntersectionGeometryIndexEXT(query, committed)), \
      uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, committed)), \
      TraceHit(rayQueryGetIntersectionTEXT(query, committed), \
      rayQueryGetIntersectionBarycentricsEXT(query, committed).x, \
      rayQueryGetIntersectionBarycentricsEXT(query, committed).y, 0u, 0u, \
      rayQueryGetIntersectionFrontFaceEXT(query, committed) ? 0u : 1u, 0u, no_trace))

void trace_search(TraceScene s, TraceRay ray, uint mode, TraceHit passed, inout TraceState state) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(s.acceleration), trace_flags(mode), 0xffu, ray.origin,
      max(state.t_min, 0.0) * TRACE_BEFORE, ray.direction, state.t_max);
  while (rayQueryProceedEXT(query)) {
    const TraceHit h = TRACE_QUERIED(query, false);
    if (!(h.t >= state.t_min && h.t <= state.t_max)) continue;
#ifdef RELIEFS
    // What lies elsewhere than the device has it is not the device's to order.
    if ((trace_item(s, h.item).flags & trace_relief_bit) != 0u) {
      if (trace_accept(s, h, true, mode, passed, state)) return;
      continue;
    }
#endif
    if ((mode & TRACE_LOCATE) != 0u)
      trace_accept(s, h, true, mode, passed, state);
    else if (trace_counts(s, h, true, mode, passed))
      rayQueryConfirmIntersectionEXT(query);
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return;
#ifdef RELIEFS
  const TraceHit nearest = TRACE_QUERIED(query, true);
  if (state.found && state.best.t <= nearest.t) return;
  state.best = nearest;
#else
  state.best = TRACE_QUERIED(query, true);
#endif
  state.found = true;
}
#endif

#ifdef TRACE_RAYGEN
layout(location = 0) rayPayloadEXT TracePayload traced;

// Not with TRACE_LOCATE.
void trace_search(TraceScene s, TraceRay ray, uint mode, TraceHit passed, inout TraceState state) {
  traced = TracePayload(passed, state.t_min, state.t_max, mode, 0u);
  traceRayEXT(accelerationStructureEXT(s.acceleration), trace_flags(mode), 0xffu, 0u, 0u, 0u, ray.origin,
      max(state.t_min, 0.0) * TRACE_BEFORE, ray.direction, state.t_max, 0);
  state.found = traced.found != 0u;
  if (state.found) state.best = traced.hit;
}
#endif
