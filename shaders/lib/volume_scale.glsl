#pragma once
// World metres to one of a mesh: the cube root of what the transform makes of volumes. Needs lib/scene.glsl.
// Rows are made of a size first: the volume itself leaves floats where its root does not.
float scale_of_volume(Transform t) {
  const vec3 a = max(max(abs(t.row0.xyz), abs(t.row1.xyz)), abs(t.row2.xyz));
  const float most = max(a.x, max(a.y, a.z));
  if (!(most > 0.0) || isinf(most)) return most > 0.0 ? most : 0.0;
  const vec3 r0 = t.row0.xyz / most, r1 = t.row1.xyz / most, r2 = t.row2.xyz / most;
  return most * pow(abs(dot(r0, cross(r1, r2))), 1.0 / 3.0);
}
