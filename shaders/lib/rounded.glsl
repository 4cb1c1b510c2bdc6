#pragma once
// Polygons of metaballs stand for a smooth surface. Near where it turns away from a light, some of them face away
// before it does and others stand in their shadow: lit by their planes it would end in dark facets. Shadows are
// therefore asked of the surface: about its own normal, from a point that is lifted off the triangle by as much as the
// surface may lie above it (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021). Needs lib/scene.glsl.
// A vertex's words lie behind the normals of its chunk: the field's normal, not turned by noise, then the lift in
// metres of the lattice.
const uint rounded_vertices = 3u * 4096u, rounded_words = 4u;

// A unit normal and the lift in relative space; zeros for other triangles.
vec4 vertex_rounded(Geometry g, Transform t, uint v) {
  if ((g.flags & geometry_rounded) == 0u) return vec4(0.0);
  const vec4 own = load4(deformable_base(g), g.normal + 3u * rounded_vertices + rounded_words * v);
  const vec3 normal = normalize_or(transform_normal(t, own.xyz), vec3(0.0));
  return vec4(normal, dot(transform_vector(t, own.w * own.xyz), normal));
}
// normal: of the triangle, on the viewer's side; point: in its plane.
void round_off(vec4 rounded, inout vec3 normal, inout vec3 point) {
  const vec3 outwards = normalize_or(rounded.xyz, vec3(0.0));
  if (outwards == vec3(0.0)) return;
  const bool from_within = dot(outwards, normal) < 0.0;
  normal = from_within ? -outwards : outwards;
  if (!from_within) point += max(rounded.w, 0.0) * outwards;
}
