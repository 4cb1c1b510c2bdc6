#pragma once
// What a vertex has, for vertex shaders and for passes that fetch a triangle's corners themselves. Needs
// lib/features.glsl and lib/scene.glsl.
vec3 vertex_normal(Geometry g, Transform t, uint v) {
  return g.normal != absent ? normalize_or(transform_normal(t, load3(deformable_base(g), g.normal + 3u * v)), vec3(0.0))
      : vec3(0.0);
}
vec4 vertex_tangent(Geometry g, Transform t, uint v) {
  if (g.tangent == absent) return vec4(0.0);
  const vec4 tangent = load4(deformable_base(g), g.tangent + 4u * v);
  // The handedness is that of mesh space: a mirrored transform turns the bitangent over.
  const float mirrored = dot(t.row0.xyz, cross(t.row1.xyz, t.row2.xyz)) < 0.0 ? -1.0 : 1.0;
  return vec4(normalize_or(transform_vector(t, tangent.xyz), vec3(0.0)), tangent.w * mirrored);
}
vec2 vertex_uv0(Geometry g, uint v) { return g.uv0 != absent ? load2(frame.vertices, g.uv0 + 2u * v) : vec2(0.0); }
vec2 vertex_uv1(Geometry g, uint v) { return g.uv1 != absent ? load2(frame.vertices, g.uv1 + 2u * v) : vec2(0.0); }
vec4 vertex_color(Geometry g, uint v) {
  return g.color != absent ? load4(frame.vertices, g.color + 4u * v) : vec4(1.0);
}
