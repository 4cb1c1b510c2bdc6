// Rays that begin on a relief. Needs lib/trace.glsl with RELIEFS.
const int RELIEF_MOST_BEFORE = 8;  // surfaces before one that is looked for: backs, and blended ones

// Where a ray that leaves a point of a relief meets that relief again, by the layer's own sides and floor as far as up
// through its plane, which the triangles tell alone; below 0: nowhere. What has been told for the triangle's own way
// out is left in trace_left.
float trace_own_relief(TracePoint from, TraceRay ray) {
  if (from.relief.item == no_trace) return -1.0;
  const TraceScene s = TraceSceneRef(TRACE_ADDRESS).s;
  const TraceTriangle triangle = trace_triangle(s, from.relief.place);
  const Relief r = trace_relief_of(s, trace_item(s, from.relief.item), triangle, from.relief.primitive);
  precise vec3 rest = frame.trace_shift_rest + ray.origin;
  ray.origin = frame.trace_shift + rest;
  vec3 start = ray.origin, along = ray.direction;
  if (from.relief.instance != no_trace && !trace_enter(trace_instance(s, from.relief.instance), ray, start, along))
    return -1.0;
  const TraceFrame f = trace_frame(start, along);
  const vec3 direction = 1.0 / f.inverse, q = f.origin - r.corner;
  vec3 row[3];
  if (!relief_rows(r, row)) return -1.0;
  const vec3 at = vec3(dot(row[0], q), dot(row[1], q), dot(row[2], q));
  const vec3 by = vec3(dot(row[0], direction), dot(row[1], direction), dot(row[2], direction));
  float end = min(ray.t_max, RELIEF_FARTHEST / max(max(abs(by.x), abs(by.y)), 1e-30));
  const float down = by.z > 0.0 ? (1.0 - at.z) / by.z : TRACE_FAR;
  end = min(end, down);
  const float through = by.z < 0.0 ? -at.z / by.z : TRACE_FAR;
  end = min(end, through);
  if (!(end > 0.0)) return -1.0;
  vec3 to = at + end * by;
  if (end == down) to.z = 1.0;  // as trace_relief
  const ReliefMet met = relief_between(r, at, to, false, 0.0);
  if (!met.met && end == through)
    trace_left = LeftRelief(from.relief.item, from.relief.primitive, from.relief.instance);
  const vec3 way = met.at - at;
  const float largest = dot(by, by);
  return met.met && largest > 0.0 ? dot(way, by) / largest : -1.0;
}
