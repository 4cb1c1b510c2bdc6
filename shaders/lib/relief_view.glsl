#pragma once
// The relief below a triangle of an item. Needs lib/scene.glsl and lib/relief.glsl.

// v: its vertices; p: its corners, in the space of the result.
Relief triangle_relief(Item item, Geometry g, uvec3 v, vec3 p[3], Material m) {
  const ReliefRecord record = relief_record(m.relief);
  Relief r;
  r.corner = p[0];
  r.e1 = p[1] - p[0];
  r.e2 = p[2] - p[0];
  vec3 local[3];
  for (int i = 0; i < 3; ++i) local[i] = load3(deformable_base(g), g.position + 3u * v[i]);
  const vec3 front = normalize_or(cross(local[1] - local[0], local[2] - local[0]), vec3(0.0));
  r.below = transform_vector(TransformsRef(frame.transforms).t[item.transform], -record.depth * front);
  const bool second = record.heights.uv_set == 1u;
  const uint at = second ? g.uv1 : g.uv0;
  r.uv = r.uv1 = r.uv2 = r.least = r.most = vec2(0.0);
  r.ends = (m.flags & material_relief_ends) != 0u && at != absent;
  if (at != absent) {
    r.uv = load2(frame.vertices, at + 2u * v.x);
    r.uv1 = load2(frame.vertices, at + 2u * v.y) - r.uv;
    r.uv2 = load2(frame.vertices, at + 2u * v.z) - r.uv;
    r.least = load2(frame.vertices, at - 4u);
    r.most = load2(frame.vertices, at - 2u);
  }
  take_heights(record, r);
  return r;
}

// Which way light of a view goes at a place.
vec3 relief_view_direction(mat4 m, vec3 position) {
  const vec4 clip = m * vec4(position, 1.0);
  const vec2 ndc = clip.xy / clip.w;
  const vec3 x = vec3(m[0][0], m[1][0], m[2][0]), y = vec3(m[0][1], m[1][1], m[2][1]);
  const vec3 z = vec3(m[0][2], m[1][2], m[2][2]), w = vec3(m[0][3], m[1][3], m[2][3]);
  const vec3 d = cross(x - ndc.x * w, y - ndc.y * w);
  return dot(w, d) - dot(z, d) < 0.0 ? -d : d;
}
// Where it meets the relief that goes through a place of the triangle. False: it passes by.
bool meet_relief_view(Relief r, vec3 entry, vec3 direction, out vec3 position) {
  vec3 row[3];
  position = entry;
  if (!relief_rows(r, row)) return true;
  bool back;
  const vec3 q = entry - r.corner;
  const ReliefMet met = relief_through(r, vec2(dot(row[0], q), dot(row[1], q)), direction, 0.0, back);
  if (met.met) position = relief_place(r, met.at);
  return met.met;
}
