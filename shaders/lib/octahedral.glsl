#pragma once
// Octahedral map of directions (Cigolle, Donow, Evangelakos, Mara, McGuire, Meyer, "A Survey of Efficient
// Representations for Independent Unit Vectors", 2014), each coordinate rounded to a number of bits. A zero vector
// becomes +z.
uint octahedral_bits(vec3 n, uint bits) {
  const float most = float((1u << bits) - 1u);
  const float sum = abs(n.x) + abs(n.y) + abs(n.z);
  vec2 p = sum > 0.0 ? n.xy / sum : vec2(0.0);
  if (n.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  const uvec2 q = uvec2(clamp((p * 0.5 + 0.5) * most + 0.5, vec2(0.0), vec2(most)));
  return q.x | q.y << bits;
}
vec3 octahedral_direction(uint stored, uint bits) {
  const uint most = (1u << bits) - 1u;
  const vec2 p = 2.0 * vec2(uvec2(stored, stored >> bits) & most) / float(most) - 1.0;
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}
