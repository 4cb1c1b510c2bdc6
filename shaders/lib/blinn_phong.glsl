// The lobe of Blinn, "Models of Light Reflection for Computer Synthesized Pictures", 1977: a power of the cosine between
// normal and half vector, normalised so that white reflects all of a uniform sky towards its normal, and less towards
// other directions (docs/understanding/blinn-phong.md). Without a Fresnel term. The specular map of a file, and
// materials of other models, have the exponent by roughness: facets are as wide for 2 / alpha^2 - 2 (Walter et al.
// 2007).
const float most_exponent = 1e6;

float exponent_of_roughness(float roughness) {
  const float alpha = roughness * roughness;
  return max(2.0 / max(alpha * alpha, 2.0 / (most_exponent + 2.0)) - 2.0, 0.0);
}
float roughness_of_exponent(float exponent) { return sqrt(sqrt(2.0 / (exponent + 2.0))); }

// f of a white lobe. sine2: squared sine between normal and half vector. The logarithm of the cosine is a series near
// the peak, where a million times its rounding error would be seen.
float blinn_phong(float exponent, float sine2) {
  const float t = clamp(sine2, 0.0, 1.0), z = t / (2.0 - t), z2 = z * z;
  const float log_cosine2 = t < 0.25 ? -2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0))))
                                     : log(max(1.0 - t, 1e-14));
  const float norm = (exponent + 2.0) * (exponent + 4.0) / (25.1327412 * (exponent + exp2(-0.5 * exponent)));
  return norm * exp(0.5 * exponent * log_cosine2);
}

// The fraction of a uniform sky that a white lobe reflects: exactly the inverse of `spread` at grazing angles, n.v^2
// for a mirror, between them a fit within 0.002 of the integral (tests/gpu/reference_blinn_phong.cpp).
float blinn_phong_albedo(float exponent, float n_v) {
  const float spread = exponent + exp2(-0.5 * exponent), r = roughness_of_exponent(exponent), r2 = r * r;
  const vec4 powers = vec4(1.0, r, r2, r2 * r);
  const vec3 bulge = vec3(dot(powers, vec4(31.6338, -73.2664, 48.0145, 12.8432)) - 18.234 * r2 * r2,
                          dot(powers, vec4(-146.099, 543.573, -698.652, 342.792)) - 41.5876 * r2 * r2,
                          dot(powers, vec4(170.615, -788.733, 1349.35, -1013.15)) + 281.909 * r2 * r2);
  const float sum = dot(bulge, vec3(1.0, n_v, n_v * n_v));
  return clamp(n_v * n_v + (1.0 - n_v) * (1.0 + n_v * sum) / spread, 0.0, 1.0);
}
