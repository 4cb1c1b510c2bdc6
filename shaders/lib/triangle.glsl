#pragma once
// A triangle's corners, and what its surface has where a ray of the camera meets it: attributes and their slopes over
// the picture, by the ray and its differential (Igehy, "Tracing Ray Differentials", 1999) instead of quotients of clip
// coordinates, so that triangles through the camera's plane need no case of their own. Needs lib/features.glsl,
// lib/scene.glsl, lib/vertex_position.glsl, lib/vertex_attributes.glsl, lib/surface.glsl with TRIANGLES defined, and
// the push constants of DrawPush that these need.
#include "lib/view_ray.glsl"
#include "shared/visibility.h"
#include "lib/view_ray.glsl"

struct Corners {
  vec3 p[3];  // relative space
  uvec3 v;    // places among the item's vertices
};
Corners load_corners(uint64_t indices, Item item, Geometry g, uint triangle) {
  WordsRef words = WordsRef(indices);
  const uint first = item.first_index + 3u * triangle;
  Corners c;
  c.v = uvec3(words.w[first], words.w[first + 1u], words.w[first + 2u]);
  for (int i = 0; i < 3; ++i) c.p[i] = relative_position(item, g, c.v[i]);
  return c;
}

// Where the ray meets the triangle's plane. weights: of the corners, and what they gain a pixel to the right and a
// pixel down.
struct TrianglePoint {
  vec3 position;
  vec3 plane;  // its normal, not of unit length: corners are counter-clockwise seen from where it points
  vec3 weights, across, down;
};
TrianglePoint meet_triangle(Corners c, ViewRay r) {
  const vec3 a = c.p[1] - c.p[0], b = c.p[2] - c.p[0];
  const vec3 most = max(abs(a), abs(b));
  const float scale = 1.0 / max(max(most.x, max(most.y, most.z)), 1e-30);
  const vec3 e1 = a * scale, e2 = b * scale, n = cross(e1, e2);
  const float towards = dot(n, r.direction), inverse = towards != 0.0 ? 1.0 / towards : 0.0;
  const float t = dot(n, c.p[0] - r.origin) * inverse;
  TrianglePoint p;
  p.plane = n;
  p.position = r.origin + t * r.direction;
  // What the point moves by: along the ray as far as keeps it in the plane.
  const float moved = frame.perspective != 0u ? t : 1.0;
  const vec3 right = moved * (r.across - r.direction * (dot(n, r.across) * inverse));
  const vec3 down = moved * (r.down - r.direction * (dot(n, r.down) * inverse));
  const float area = dot(n, n), by_area = area > 0.0 ? 1.0 / area : 0.0;
  const vec3 u = cross(e2, n) * by_area, v = cross(n, e1) * by_area;
  // By the ray's moments about the edges (Moeller and Trumbore, 1997), not by the point, whose rounding along the ray
  // is a fraction of its distance and reaches over small triangles that slope.
  const vec3 q = (r.origin - c.p[0]) * scale;
  // No attribute is taken from beside the triangle.
  float w1 = clamp(dot(q, cross(e2, r.direction)) * inverse, 0.0, 1.0);
  float w2 = clamp(dot(q, cross(r.direction, e1)) * inverse, 0.0, 1.0);
  const float over = max(w1 + w2, 1.0);
  w1 /= over;
  w2 /= over;
  p.weights = vec3(1.0 - w1 - w2, w1, w2);
  const vec2 to_right = scale * vec2(dot(right, u), dot(right, v)), to_below = scale * vec2(dot(down, u), dot(down, v));
  p.across = vec3(-to_right.x - to_right.y, to_right);
  p.down = vec3(-to_below.x - to_below.y, to_below);
  return p;
}

vec2 weighted(vec3 w, vec2 a, vec2 b, vec2 c) { return w.x * a + w.y * b + w.z * c; }

// What base colours are made of.
void put_base_varyings(Geometry g, Corners c, TrianglePoint p, inout Varyings v) {
  if (HAS_TEXTURES != 0) {
    const vec2 a = vertex_uv0(g, c.v.x), b = vertex_uv0(g, c.v.y), d = vertex_uv0(g, c.v.z);
    v.uv0 = weighted(p.weights, a, b, d);
    v.uv0_across = weighted(p.across, a, b, d);
    v.uv0_down = weighted(p.down, a, b, d);
  }
  if (HAS_UV1 != 0) {
    const vec2 a = vertex_uv1(g, c.v.x), b = vertex_uv1(g, c.v.y), d = vertex_uv1(g, c.v.z);
    v.uv1 = weighted(p.weights, a, b, d);
    v.uv1_across = weighted(p.across, a, b, d);
    v.uv1_down = weighted(p.down, a, b, d);
  }
  v.color = vec4(1.0);
  if (HAS_VERTEX_COLOR != 0)
    v.color = p.weights.x * vertex_color(g, c.v.x) + p.weights.y * vertex_color(g, c.v.y) +
        p.weights.z * vertex_color(g, c.v.z);
}
Varyings no_varyings() {
  Varyings v;
  v.relative_position = v.normal = v.normal_across = v.normal_down = vec3(0.0);
  v.tangent = vec4(0.0);
  v.uv0 = v.uv1 = v.uv0_across = v.uv0_down = v.uv1_across = v.uv1_down = vec2(0.0);
  v.color = vec4(1.0);
  return v;
}
#ifdef RELIEFS
#include "lib/relief.glsl"
#include "lib/relief_triangle.glsl"
#endif
#ifdef SCATTERS
#include "lib/volume_scale.glsl"
#endif
Varyings lit_varyings(Item item, Geometry g, Corners c, TrianglePoint p) {
  Varyings v = no_varyings();
  v.relative_position = p.position;
  put_base_varyings(g, c, p, v);
  const Transform t = TransformsRef(frame.transforms).t[item.transform];
#ifdef SCATTERS
  v.scale = scale_of_volume(t);
#endif
  const vec3 n0 = vertex_normal(g, t, c.v.x), n1 = vertex_normal(g, t, c.v.y), n2 = vertex_normal(g, t, c.v.z);
  v.normal = p.weights.x * n0 + p.weights.y * n1 + p.weights.z * n2;
  v.normal_across = p.across.x * n0 + p.across.y * n1 + p.across.z * n2;
  v.normal_down = p.down.x * n0 + p.down.y * n1 + p.down.z * n2;
  if (HAS_TANGENT)
    v.tangent = p.weights.x * vertex_tangent(g, t, c.v.x) + p.weights.y * vertex_tangent(g, t, c.v.y) +
        p.weights.z * vertex_tangent(g, t, c.v.z);
  return v;
}

#ifdef ROUNDED
#include "lib/rounded.glsl"
void round_off(Item item, Geometry g, Corners c, TrianglePoint p, inout vec3 normal, inout vec3 point) {
  const Transform t = TransformsRef(frame.transforms).t[item.transform];
  round_off(p.weights.x * vertex_rounded(g, t, c.v.x) + p.weights.y * vertex_rounded(g, t, c.v.y) +
      p.weights.z * vertex_rounded(g, t, c.v.z), normal, point);
}
#else
void round_off(Item item, Geometry g, Corners c, TrianglePoint p, inout vec3 normal, inout vec3 point) {}
#endif

#ifdef RELIEFS
// Of a point of a relief: its weights may be those of a place beside the triangle, where textures go on, and what else
// the corners have ends at the edge.
Varyings relief_varyings(Item item, Geometry g, Corners c, TrianglePoint p, ReliefPoint point) {
  TrianglePoint inside = p;
  inside.weights = max(p.weights, vec3(0.0));
  inside.weights /= inside.weights.x + inside.weights.y + inside.weights.z;
  Varyings v = lit_varyings(item, g, c, inside);
  const vec4 color = v.color;
  put_base_varyings(g, c, p, v);
  v.color = color;
  v.normal += point.lean;
  return v;
}
#endif
