#pragma once
// A facet's normal out of those that a viewer sees, about the z axis (Heitz, "Sampling the GGX Distribution of Visible
// Normals", 2018). stretched: the direction to the viewer times alpha in x and y, unit; t1, t2: unit, across it; disc: a
// place on the unit disc.
vec3 visible_normal(vec3 stretched, vec3 t1, vec3 t2, vec2 alpha, vec2 disc) {
  const float s = 0.5 * (1.0 + stretched.z);
  const float y = (1.0 - s) * sqrt(max(1.0 - disc.x * disc.x, 0.0)) + s * disc.y;
  const vec3 nh = disc.x * t1 + y * t2 + sqrt(max(1.0 - disc.x * disc.x - y * y, 0.0)) * stretched;
  return normalize(vec3(alpha * nh.xy, max(nh.z, 1e-6)));
}
