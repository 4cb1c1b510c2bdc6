// A point of a triangle, with what is needed to leave it. Part of lib/trace.glsl.
struct TracePoint {
  vec3 position, normal;  // relative; the normal is unit, towards the glTF front; 0 for a degenerate triangle
  float error_m;          // a ray that begins this far off along the normal does not meet the triangle again
#ifdef RELIEFS
  TraceHit relief;        // of a point on a relief: its triangle; item no_trace: it is on none
#endif
};
TracePoint trace_free_point(vec3 position, vec3 normal, float error_m) {
  TracePoint point;
  point.position = position;
  point.normal = normal;
  point.error_m = error_m;
#ifdef RELIEFS
  point.relief = TRACE_NOTHING;
  point.relief.item = no_trace;
#endif
  return point;
}

vec3 leaving_origin(TracePoint point, vec3 direction) {
  const float side = dot(direction, point.normal) < 0.0 ? -1.0 : 1.0;
  return point.position + (side * point.error_m) * point.normal;
}
