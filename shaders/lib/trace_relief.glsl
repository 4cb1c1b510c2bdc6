// Reliefs of the trees' triangles. Part of lib/trace.glsl.
#include "lib/relief.glsl"

// The relief below a triangle of the trees, in its space.
Relief trace_relief_of(TraceScene s, TraceItem item, TraceTriangle triangle, uint primitive) {
  const TraceCorners bounds = trace_corners(s, item.first_corner);
  const TraceCorners c = trace_corners(s, item.first_corner + 1u + primitive);
  Relief r;
  r.corner = triangle.a;
  r.e1 = triangle.b - triangle.a;
  r.e2 = triangle.c - triangle.a;
  r.below = c.alpha;
  r.uv = c.uv[0];
  r.uv1 = c.uv[1] - c.uv[0];
  r.uv2 = c.uv[2] - c.uv[0];
  r.least = bounds.uv[0];
  r.most = bounds.uv[1];
  r.ends = bounds.alpha.x != 0.0;
  take_heights(relief_record(MaterialsRef(frame.materials).m[item.material].relief), r);
  return r;
}
// The relief that a ray leaves and that trace_own_relief() has found open as far as up through its plane: its triangle
// is not asked once more.
struct LeftRelief {
  uint item, primitive, instance;
};
LeftRelief trace_left = LeftRelief(no_trace, 0u, 0u);

// A hit of such a triangle becomes that of its relief, as the reference has it (World::meet_relief): below the
// triangle, or before it where the ray begins in the layer or comes from behind. False: there is none.
bool trace_relief(TraceScene s, TraceItem item, TraceTriangle triangle, vec3 direction, float t_min, float t_max,
                  inout TraceHit h) {
  const Relief r = trace_relief_of(s, item, triangle, h.primitive);
  vec3 row[3];
  if (!relief_rows(r, row)) return true;
  const vec3 by = vec3(dot(row[0], direction), dot(row[1], direction), dot(row[2], direction));
  if (by.z == 0.0) return true;
  const vec3 entry = vec3(h.u, h.v, 0.0);
  const float through = 1.0 / by.z, begin = t_min - h.t;  // t from the plane to the floor; that of the ray's begin
  ReliefMet met;
  if (through > 0.0) {
    // The floor itself, which a product's rounding may fall short of: heights of 1 lie there.
    met = relief_between(r, entry, vec3(entry.xy + through * by.xy, 1.0), true, 0.0);
  } else if (through < begin) {
    if (h.item == trace_left.item && h.primitive == trace_left.primitive && h.instance == trace_left.instance)
      return false;
    met = relief_between(r, entry + begin * by, entry, false, 0.0);
    h.back = 0u;
  } else {
    met = ReliefMet(true, entry + through * by);
    const vec2 uv = r.uv + met.at.x * r.uv1 + met.at.y * r.uv2;
    if (r.ends && (any(lessThan(uv, r.least)) || any(greaterThan(uv, r.most))))
      met = relief_between(r, met.at, entry, true, 0.0);
    else
      h.back = 1u;
  }
  if (!met.met) return false;
  h.t += met.at.z * through;
  h.u = met.at.x;
  h.v = met.at.y;
  return h.t >= t_min && h.t <= t_max;
}

bool trace_on_relief(TraceScene s, TraceTriangle triangle, TraceFrame f, TraceState state, inout TraceHit h) {
  const TraceItem item = trace_item(s, h.item);
  return (item.flags & trace_relief_bit) == 0u ||
      trace_relief(s, item, triangle, 1.0 / f.inverse, state.t_min, state.t_max, h);
}

// A point of such a triangle becomes that of its relief; what roundings may put it off by is returned. corner, e1, e2:
// the triangle, in relative space or that of the trees.
float put_on_relief(TraceScene s, TraceItem item, TraceTriangle triangle, TraceHit h, vec3 corner, vec3 e1, vec3 e2,
                    inout TracePoint point) {
  if ((item.flags & trace_relief_bit) == 0u) return 0.0;
  Relief r = trace_relief_of(s, item, triangle, h.primitive);
  r.corner = corner;
  r.e1 = e1;
  r.e2 = e2;
  if (h.instance != no_trace) {
    const TraceInstance i = trace_instance(s, h.instance);
    r.below = vec3(dot(i.relative_row[0].xyz, r.below), dot(i.relative_row[1].xyz, r.below),
        dot(i.relative_row[2].xyz, r.below));
  }
  const vec2 at = vec2(h.u, h.v);
  point.position = relief_place(r, vec3(at, h.back != 0u ? 1.0 : relief_height(r, at)));
  if (h.back != 0u) return 0.0;
  point.relief = h;
  const vec2 slope = relief_slope(r, at, 0.0, 0.0);
  const vec3 leaned = point.normal + relief_lean(r, slope);
  const float size2 = dot(leaned, leaned);
  if (size2 > 0.0 && !isinf(size2)) point.normal = leaned * inversesqrt(size2);
  const vec2 steps = abs(at) + 1.0;
  const float deep = (1.0 + dot(abs(slope), steps)) * length(r.below);
  return 2.3841858e-7 * (steps.x * length(e1) + steps.y * length(e2) + deep);
}
