// Lobes on the metallic-roughness base, as their Khronos extensions state them. Part of lib/brdf.glsl where LOBED.
//
// Sheen lies on the base, the clear coat on both; each leaves a fraction of the light to what is under it. The coat's
// is of its own normal and the viewer, the sheen's the lesser of those towards the viewer and towards the light.
// Iridescence replaces the base's Fresnel terms, anisotropy stretches its facets, diffuse transmission parts its
// diffuse light between the sides.
#include "shared/sheen_albedo.h"

float largest(vec3 c) { return max(c.r, max(c.g, c.b)); }

float schlick(float f0, float cosine) {
  const float x = clamp(1.0 - cosine, 0.0, 1.0), x2 = x * x;
  return f0 + (1.0 - f0) * (x2 * x2 * x);
}
float reflectance_at_normal(float behind, float before) {
  const float r = (behind - before) / (behind + before);
  return r * r;
}

// Interference of waves `path_nm` apart, shifted by an angle in each channel: the eye's sensitivities as normal
// distributions, whose Fourier transforms these are; to linear Rec. 709.
vec3 film_sensitivity(float path_nm, vec3 shift) {
  // Behind this path all is washed out.
  const float phase = 6.2831853e-9 * min(path_nm, 1e7), phase2 = phase * phase;
  const float root_two_pi = 2.5066283;
  const vec4 amplitude = vec4(5.4856e-6, 4.4201e-6, 5.2481e-6, 0.9747e-6) / 1.0685 *
                         (root_two_pi * sqrt(vec4(4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9)));
  const vec4 position = vec4(1.6810e6, 1.7953e6, 2.2084e6, 2.2399e6);
  const vec4 wave = amplitude * cos(position * phase + vec4(shift, shift.x)) *
                    exp(-phase2 * vec4(4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9));
  const vec3 xyz = vec3(wave.x + wave.w, wave.yz);
  return mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252) *
         xyz;
}

// What a thin film in air with a base of f0 under it reflects (Belcour and Barla, "A Practical Extension to Microfacet
// Theory for the Modeling of Varying Iridescence", 2017, in KHR_materials_iridescence's form: Schlick at both
// interfaces, two orders of interference). The path difference has the angle inside the film. Cut to [0, 1], from which
// the model strays by colours outside of Rec. 709. The phase turns where the base's index passes the film's; the base's
// comes from a rounded f0, so that indices nearer than a part of 1e-5 are equal.
vec3 film_reflectance(float cosine, float ior, float thickness_nm, vec3 f0) {
  const float c = clamp(cosine, 0.0, 1.0);
  const float film = mix(1.0, clamp(ior, 1.0, 1e9), smoothstep(0.0, 0.03, thickness_nm));  // the thinnest fade to air
  const float inside = sqrt(max(1.0 - (1.0 - c * c) / (film * film), 0.0));
  const float r12 = schlick(reflectance_at_normal(film, 1.0), c), t121 = 1.0 - r12;
  vec3 shift, rs, r123, sum;
  for (int i = 0; i < 3; ++i) {
    const float root = sqrt(clamp(f0[i], 0.0, 0.9999)), base = (1.0 + root) / (1.0 - root);
    const float r23 = schlick(reflectance_at_normal(base, film), inside);
    shift[i] = base < film * (1.0 - 1e-5) ? 2.0 * PI : PI;
    const float both = clamp(r12 * r23, 1e-5, 0.9999);
    rs[i] = t121 * t121 * r23 / (1.0 - both);
    r123[i] = sqrt(both);
    sum[i] = r12 + rs[i];
  }
  const float path_nm = 2.0 * film * min(thickness_nm, 1e9) * inside;
  const vec3 first = (rs - t121) * r123;
  sum += 2.0 * first * film_sensitivity(path_nm, shift);
  sum += 2.0 * first * r123 * film_sensitivity(2.0 * path_nm, 2.0 * shift);
  return clamp(sum, vec3(0.0), vec3(1.0));
}

// Fibres that stand up (Conty Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017): "Charlie" and its
// fit of Smith's lambda, as KHR_materials_sheen prints them.
float sheen_alpha(float roughness) {
  const float r = max(roughness, least_sheen_roughness);
  return r * r;
}
float sheen_lambda(float cosine, float alpha) {
  const float t = (1.0 - alpha) * (1.0 - alpha), c = clamp(cosine, 0.0, 1.0);
  const float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), p = mix(0.19823, 0.16801, t),
              d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
  const float x = c < 0.5 ? c : 1.0 - c;
  const float exponent = a / (1.0 + b * pow(max(x, 1e-20), p)) + d * x + e;
  const float middle = a / (1.0 + b * pow(0.5, p)) + d * 0.5 + e;
  return exp(c < 0.5 ? exponent : 2.0 * middle - exponent);
}
// The fraction of a uniform sky that white fibres reflect; above 1 at grazing angles where they are straight.
float sheen_entry(int row, int column) {
  const int at = row * sheen_albedo_columns + column;
  return unpackUnorm2x16(sheen_albedo_words[at >> 1])[at & 1];
}
// Of the polynomial of third degree through places 0 to 3.
vec4 cubic_weights(float at) {
  const vec4 d = at - vec4(0.0, 1.0, 2.0, 3.0);
  return vec4(-d.y * d.z * d.w, 3.0 * d.x * d.z * d.w, -3.0 * d.x * d.y * d.w, d.x * d.y * d.z) / 6.0;
}
float sheen_albedo(float roughness, float cosine) {
  const float r = clamp(roughness, least_sheen_roughness, 1.0), c = clamp(cosine, least_sheen_cosine, 1.0);
  const float least = sqrt(sqrt(least_sheen_cosine));
  const float y = sqrt((r - least_sheen_roughness) / (1.0 - least_sheen_roughness)) * float(sheen_albedo_rows - 1);
  const float x = (sqrt(sqrt(c)) - least) / (1.0 - least) * float(sheen_albedo_columns - 1);
  const int row = clamp(int(y) - 1, 0, sheen_albedo_rows - 4), column = clamp(int(x) - 1, 0, sheen_albedo_columns - 4);
  const vec4 down = cubic_weights(y - float(row)), across = cubic_weights(x - float(column));
  float sum = 0.0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) sum += down[i] * across[j] * sheen_entry(row + i, column + j);
  return sheen_albedo_most * max(sum, 0.0);
}

// What the lobes of a shaded point share, beside the base's.
struct BrdfLobes {
  float coat_takes;  // the fraction of light that the coat mirrors to the viewer
  vec3 coat_normal;
  float coat_n_v, coat_smith_v, coat_alpha, coat_alpha2;  // as the base's
  vec3 sheen;         // color, over what its lobe has too much energy, times what the coat leaves
  float sheen_most;   // strongest channel of the colour
  float sheen_takes;  // share that the sheen takes towards the viewer
  float sheen_roughness, sheen_alpha, sheen_lambda_v;
  float film, film_ior, film_nm;
  vec3 dielectric_f0, metal_f0, gain;
  float dielectric_f90, metallic;
  vec3 tangent, bitangent;
  float tangent_alpha, smith_v;  // of stretched facets; alpha 0: they are round
  vec3 passing;                  // diffuse light through the surface, over pi, before what Fresnel takes
#ifdef SCATTERS
  float slab_m;                  // as of the surface
#endif
};
