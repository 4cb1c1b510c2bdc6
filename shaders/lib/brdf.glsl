// Metallic-roughness BRDF of glTF 2.0, appendix B: GGX (Walter et al. 2007), height-correlated Smith (Heitz 2014), Schlick.
const float PI = 3.14159265358979323846;

// alpha below this overflows D at its peak in 32-bit float arithmetic (TECHNIQUES 9.1: perceptual roughness 0.045).
const float MIN_PERCEPTUAL_ROUGHNESS = 0.045;

// D V with 1 - (n.h)^2 taken as |n x h|^2, which does not cancel near the peak.
float ggx_dv(vec3 n, vec3 h, float n_l, float n_v, float alpha) {
  const vec3 nxh = cross(n, h);
  const float n_h = dot(n, h);
  const float a = n_h * alpha;
  const float k = alpha / (dot(nxh, nxh) + a * a);
  const float d = k * k / PI;
  const float a2 = alpha * alpha;
  const float v = 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2) + 1e-7);
  return d * v;
}

// f * n.l for light from unit direction l to unit direction v.
vec3 evaluate_brdf(Surface s, vec3 l, vec3 v) {
  const float n_l = dot(s.normal, l);
  if (!(n_l > 0.0)) return vec3(0.0);
  const float n_v = max(abs(dot(s.normal, v)), 1e-4);
  const vec3 sum = l + v;
  const float length2 = dot(sum, sum);
  const vec3 h = length2 > 1e-12 ? sum * inversesqrt(length2) : s.normal;
  const float roughness = max(s.roughness, MIN_PERCEPTUAL_ROUGHNESS);
  const float specular = ggx_dv(s.normal, h, n_l, n_v, roughness * roughness);
  const float grazing = pow(clamp(1.0 - dot(v, h), 1e-7, 1.0), 5.0);
  const vec3 f_dielectric = s.dielectric_f0 + (vec3(s.dielectric_f90) - s.dielectric_f0) * grazing;
  const vec3 f_metal = s.base_color + (1.0 - s.base_color) * grazing;
  const float diffuse_left = 1.0 - max(f_dielectric.r, max(f_dielectric.g, f_dielectric.b));
  const vec3 dielectric = s.base_color * (diffuse_left / PI) + specular * f_dielectric;
  return mix(dielectric, specular * f_metal, s.metallic) * n_l;
}
