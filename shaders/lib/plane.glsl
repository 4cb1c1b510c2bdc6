#pragma once
// The plane of a fragment's triangle. Needs lib/scene.glsl, and a fragment shader.

// The triangle's own normal, on the viewer's side, from a position that is interpolated to the pixel's middle. Outside
// of branches that differ between neighbours only.
#ifndef TRIANGLES
vec3 triangle_normal(vec3 position, vec3 to_viewer) {
  const vec3 n = normalize_or(cross(dFdx(position), dFdy(position)), to_viewer);
  return dot(n, to_viewer) < 0.0 ? -n : n;
}
#endif

// A point of the triangle near one that was interpolated to a centroid: llvmpipe 25.0.7 divides by the depth of the
// pixel's middle there, which leaves the point off its surface. Where the two places are one nothing is moved.
vec3 onto_triangle(vec3 position, vec3 normal, vec3 in_plane) {
  return position + normal * dot(normal, in_plane - position);
}
