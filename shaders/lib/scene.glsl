// Reads the scene through device addresses. Needs `DrawPush` (shared/draw.h) as the push constants `pc`.
#include "lib/bindless.glsl"
#include "lib/frame.glsl"

// The middle of the pixel that is shaded.
#ifdef RELIEF  // a fragment that takes its triangle's corners
#define TRIANGLES
#endif
#ifdef TRIANGLES
vec2 pixel_middle;
#define PIXEL_MIDDLE pixel_middle
#else
#define PIXEL_MIDDLE gl_FragCoord.xy
#endif

Item load_item(uint i) { return ItemsRef(frame.items).i[i]; }
Geometry load_geometry(uint i) { return GeometriesRef(frame.geometries).g[i]; }

vec3 load3(uint64_t base, uint word) {
  FloatsRef s = FloatsRef(base);
  return vec3(s.f[word], s.f[word + 1u], s.f[word + 2u]);
}
vec4 load4(uint64_t base, uint word) {
  FloatsRef s = FloatsRef(base);
  return vec4(s.f[word], s.f[word + 1u], s.f[word + 2u], s.f[word + 3u]);
}
vec2 load2(uint64_t base, uint word) {
  FloatsRef s = FloatsRef(base);
  return vec2(s.f[word], s.f[word + 1u]);
}
uint64_t deformable_base(Geometry g) { return (g.flags & geometry_deformed) != 0u ? pc.deformed : frame.vertices; }

vec3 transform_point(Transform t, vec3 p) {
  return vec3(dot(t.row0.xyz, p) + t.row0.w, dot(t.row1.xyz, p) + t.row1.w, dot(t.row2.xyz, p) + t.row2.w);
}
vec3 transform_vector(Transform t, vec3 v) { return vec3(dot(t.row0.xyz, v), dot(t.row1.xyz, v), dot(t.row2.xyz, v)); }
// By the cofactor matrix: the inverse transpose times the determinant, finite for singular transforms too. A mirrored
// transform flips it, so the sign of the determinant is given back.
vec3 transform_normal(Transform t, vec3 n) {
  const vec3 a = t.row0.xyz, b = t.row1.xyz, c = t.row2.xyz;
  const vec3 ca = cross(b, c), cb = cross(c, a), cc = cross(a, b);
  const float flip = dot(a, ca) < 0.0 ? -1.0 : 1.0;
  return flip * vec3(dot(ca, n), dot(cb, n), dot(cc, n));
}

// A zero vector gives the fallback instead of NaN.
vec3 normalize_or(vec3 v, vec3 fallback) {
  const float m = max(abs(v.x), max(abs(v.y), abs(v.z)));
  if (!(m > 0.0) || isinf(m)) return fallback;
  v /= m;  // no overflow or underflow of the square
  return v * inversesqrt(dot(v, v));
}
