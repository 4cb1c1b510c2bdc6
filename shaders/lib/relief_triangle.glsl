#pragma once
// The relief below a triangle that is drawn. Needs lib/triangle.glsl and lib/relief.glsl.
#include "lib/relief_view.glsl"

// Weights of the second and third corner where a ray meets the triangle's plane, also beside the triangle: as
// meet_triangle.
vec2 relief_entry(Corners c, ViewRay ray) {
  const vec3 a = c.p[1] - c.p[0], b = c.p[2] - c.p[0];
  const vec3 most = max(abs(a), abs(b));
  const float scale = 1.0 / max(max(most.x, max(most.y, most.z)), 1e-30);
  const vec3 e1 = a * scale, e2 = b * scale, q = (ray.origin - c.p[0]) * scale;
  const float towards = dot(cross(e1, e2), ray.direction), inverse = towards != 0.0 ? 1.0 / towards : 0.0;
  // Once more with what is left: a quotient may be off by 2.5 units in the last place, a share of the way over the
  // triangle, which all its texels lie on.
  const vec3 u = cross(e2, ray.direction), v = cross(ray.direction, e1);
  const vec2 w = vec2(dot(q, u), dot(q, v)) * inverse;
  const vec3 rest = q - w.x * e1 - w.y * e2;
  return w + vec2(dot(rest, u), dot(rest, v)) * inverse;
}

// What shading takes of it. front: the unit normal of the surface, towards the glTF front; lean: what leans a vertex
// normal over; at: its place in the layer, whose heights have been read at level lod; back: it is seen from behind.
struct ReliefPoint {
  vec3 front, lean;
  Relief layer;
  vec3 at;
  float lod;
  bool back;
};
void put_relief_place(Relief r, vec3 at, inout TrianglePoint p) {
  p.position = relief_place(r, at);
  p.weights = vec3(1.0 - at.x - at.y, at.xy);
}
ReliefPoint relief_point_at(Relief r, Material m, vec3 at, float lod, bool back) {
  ReliefPoint point = ReliefPoint(normalize_or(cross(r.e1, r.e2), vec3(0.0)), vec3(0.0), r, at, lod, back);
  if (dot(point.front, r.below) > 0.0) point.front = -point.front;
  if (back) return point;
  const float over = exp2(lod);
  const vec3 lean = relief_lean(r, relief_slope(r, at.xy, over > 1.0 ? over : 0.0, lod));
  point.front = normalize_or(point.front + lean, point.front);
  if (m.normal_texture.texture == absent) point.lean = relief_lean(r, relief_slope(r, at.xy, max(over, 1.0), lod));
  return point;
}
// The point of a triangle where a ray meets it becomes that of its relief. False: it passes by.
bool meet_relief(Item item, Geometry g, Corners c, Material m, ViewRay ray, inout TrianglePoint p,
                 out ReliefPoint point) {
  const Relief r = triangle_relief(item, g, c.v, c.p, m);
  const float lod = relief_level(r, p.across, p.down);
  bool back;
  const ReliefMet met = relief_through(r, relief_entry(c, ray), ray.direction, lod, back);
  if (met.met) put_relief_place(r, met.at, p);
  point = relief_point_at(r, m, met.at, lod, back);
  return met.met;
}
// Its place alone.
bool meet_relief_depth(Item item, Geometry g, Corners c, Material m, ViewRay ray, inout TrianglePoint p) {
  const Relief r = triangle_relief(item, g, c.v, c.p, m);
  bool back;
  const ReliefMet met =
      relief_through(r, relief_entry(c, ray), ray.direction, relief_level(r, p.across, p.down), back);
  if (met.met) put_relief_place(r, met.at, p);
  return met.met;
}
