// Ambient light from the environment's (or the neutral default's) spherical harmonics up to l = 2 (Ramamoorthi and
// Hanrahan 2001). Wrong by construction: reflections are as blurred as diffuse light is, until prefiltered maps come.
vec3 ambient_radiance(vec3 n) {
  const vec4 sh[9] = frame.ambient_sh;
  vec3 e = sh[0].rgb * 0.282095 + sh[1].rgb * (0.488603 * n.y) + sh[2].rgb * (0.488603 * n.z) +
           sh[3].rgb * (0.488603 * n.x) + sh[4].rgb * (1.092548 * n.x * n.y) + sh[5].rgb * (1.092548 * n.y * n.z) +
           sh[6].rgb * (0.315392 * (3.0 * n.z * n.z - 1.0)) +
           sh[7].rgb * (1.092548 * n.x * n.z) + sh[8].rgb * (0.546274 * (n.x * n.x - n.y * n.y));
  return max(e, vec3(0.0));
}
// Scale and bias of f0 in the split sum, an analytic fit (Karis, "Physically Based Shading on Mobile", 2014).
vec2 environment_brdf(float roughness, float n_v) {
  const vec4 c0 = vec4(-1.0, -0.0275, -0.572, 0.022), c1 = vec4(1.0, 0.0425, 1.04, -0.04);
  const vec4 r = roughness * c0 + c1;
  const float a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
  return vec2(-1.04, 1.04) * a004 + r.zw;
}
vec3 ambient_light(Surface s, vec3 v) {
  const float n_v = clamp(dot(s.normal, v), 1e-4, 1.0);
  const vec2 ab = environment_brdf(s.roughness, n_v);
  const vec3 f_dielectric = s.dielectric_f0 * ab.x + s.dielectric_f90 * ab.y;
  const vec3 f_metal = s.base_color * ab.x + ab.y;
  const float diffuse_left = 1.0 - max(f_dielectric.r, max(f_dielectric.g, f_dielectric.b));
  const vec3 diffuse = s.base_color * diffuse_left * (1.0 - s.metallic) * ambient_radiance(s.normal);
  const vec3 specular = mix(f_dielectric, f_metal, s.metallic) * ambient_radiance(reflect(-v, s.normal));
  return (diffuse + specular) * s.occlusion;
}
