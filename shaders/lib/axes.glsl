#pragma once
// Axes whose third is the unit vector n (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
mat3 axes_about(vec3 n) {
  const float handed = n.z < 0.0 ? -1.0 : 1.0, p = -1.0 / (handed + n.z), q = n.x * n.y * p;
  return mat3(vec3(1.0 + handed * n.x * n.x * p, handed * q, -handed * n.x), vec3(q, handed + n.y * n.y * p, -n.y), n);
}
