// Metallic-roughness BRDF of glTF 2.0, appendix B: GGX (Walter et al. 2007), height-correlated Smith (Heitz 2014),
// Schlick; and the light that bounces more than once between facets (Turquin, "Practical Multiple Scattering
// Compensation for Microfacet Models", 2019).
#include "shared/split_sum.h"
#include "lib/pi.glsl"

// What further bounces between facets return of a lobe without colour, over its first: 1/E - 1, where E is the
// fraction of a uniform sky that GGX facets reflect once. A fit in alpha and visible = n.v / sqrt(n.v^2 (1 - alpha^2)
// + alpha^2), with which E (1 + it) is within 0.006 of 1, within a degree of grazing 0.008
// (tests/unit/reference_albedo.cpp).
float further_bounces(float alpha, float visible) {
  const vec4 powers = vec4(1.0, alpha, alpha * alpha, alpha * alpha * alpha);
  const float c1 = dot(powers, vec4(0.25913, 0.000180769, 4.20931, -0.24951));
  const float c2 = dot(powers, vec4(-0.826616, 1.85641, -18.1444, 3.01914));
  const float c3 = dot(powers, vec4(3.97086, -5.33695, 36.7748, 13.3698));
  const float c4 = dot(powers, vec4(-8.91993, 5.53192, -29.5164, -53.0425));
  const float c5 = dot(powers, vec4(9.34809, -1.18695, -0.449344, 65.411));
  const float c6 = dot(powers, vec4(-3.83096, -0.926116, 8.6848, -27.7572));
  return visible * (c1 + visible * (c2 + visible * (c3 + visible * (c4 + visible * (c5 + visible * c6)))));
}

#ifdef LOBED
#include "lib/lobes.glsl"
#endif

// What all lights of a shaded point share. The mix of the dielectric and the metal is linear in both Fresnel terms, and
// what a dielectric's strongest channel reflects is the Fresnel term of its strongest f0.
struct BrdfTerms {
  vec3 normal, to_viewer;
  float n_v, smith_v;     // cosine, and the square root of the Smith term that holds it
  float alpha, alpha2;    // roughness squared, and that squared
  float exponent;         // of Blinn's lobe, which has no Fresnel term: f90 is f0; below 0: facets
  vec3 f0, f90;           // of the mix, with what further bounces between facets add
  vec3 diffuse;           // of the dielectric part, over pi, before what Fresnel takes
  float f0_max, f90_max;  // of the dielectric's strongest channel
#ifdef LOBED
  BrdfLobes lobes;
#endif
};

#ifdef LOBED
float ggx_dv(BrdfTerms b, vec3 h, float h_h, float n_l);
float lobe_dv(BrdfTerms b, vec3 h, float h_h, float n_l);
#include "lib/lobes_eval.glsl"
#endif

BrdfTerms brdf_terms(Surface s, vec3 v) {
  BrdfTerms b;
  b.normal = s.normal;
  b.to_viewer = v;
  b.n_v = max(abs(dot(s.normal, v)), 1e-4);
  const float roughness = max(s.roughness, least_roughness);
  b.alpha = roughness * roughness;
  b.alpha2 = b.alpha * b.alpha;
  b.smith_v = sqrt(b.n_v * b.n_v * (1.0 - b.alpha2) + b.alpha2);
  b.f0 = mix(s.dielectric_f0, s.base_color, s.metallic);
  b.exponent = -1.0;
#ifdef LOBED
  vec3 gain = 1.0 + b.f0 * facets_further_bounces(s, b);
#else
  vec3 gain = 1.0 + b.f0 * further_bounces(b.alpha, b.n_v / b.smith_v);
#endif
  b.f0 *= gain;
  b.f90 = mix(s.dielectric_f90, 1.0, s.metallic) * gain;
  b.diffuse = s.base_color * ((1.0 - s.metallic) / PI);
  b.f0_max = max(s.dielectric_f0.r, max(s.dielectric_f0.g, s.dielectric_f0.b));
  b.f90_max = s.dielectric_f90;
  if (BLINN_PHONG != 0 && !s.has_facets) {
    b.exponent = exponent_of_roughness(s.roughness);
    gain = vec3(1.0);
    b.f0 = b.f90 = mix(s.dielectric_f0, s.base_color, s.metallic);
    b.f90_max = b.f0_max;
  }
#ifdef SCATTERS
  b.diffuse = s.lobes.front * ((1.0 - s.metallic) / PI);
#elif defined(LOBED)
  b.diffuse *= 1.0 - s.lobes.passing;
#endif
#ifdef LOBED
  b.lobes = brdf_lobes(s, b, gain);
#endif
  return b;
}

// Of a sun that a smooth surface mirrors: its lobe times the cosine to light, and how much of the lobe that is
// (lib/light_eval.glsl); below 0: none.
float mirrored_lobe = -1.0, mirrored_share = 0.0;
#ifdef FACETS_DISC
// Of facets, D is the mean over a disc of slopes about the half vector of this radius.
float facets_disc = 0.0;
#endif
// D V for the half vector h of any length but zero: with 1 - (n.h)^2 taken as |n x h|^2, which does not cancel near the
// peak, and one division for all.
float ggx_dv(BrdfTerms b, vec3 h, float h_h, float n_l) {
  const vec3 nxh = cross(b.normal, h);
  const float a = dot(b.normal, h) * b.alpha;
  const float k = dot(nxh, nxh) + a * a;
  const float smith = n_l * b.smith_v + b.n_v * sqrt(n_l * n_l * (1.0 - b.alpha2) + b.alpha2) + 1e-7;
#ifdef FACETS_DISC
  // A stereographic projection takes the slopes of GGX evenly to the sphere, and discs to caps: their fraction is
  // closed. With a disc of no size this is the line below.
  const float n_h2 = dot(b.normal, h) * dot(b.normal, h), disc = facets_disc * facets_disc * n_h2;
  const float off = k - disc, root = sqrt(off * off + 4.0 * a * a * disc);
  const float fraction = off > 0.0 ? 2.0 * b.alpha2 / (root + off) : 0.5 * (root - off) / max(disc * n_h2, 1e-30);
  return (0.5 / PI) * h_h * h_h * fraction / (root * smith);
#endif
  if (MIRROR_TAPS != 0 && mirrored_lobe >= 0.0)
    return mix((0.5 / PI) * b.alpha2 * h_h * h_h / (k * k * smith), mirrored_lobe / max(n_l, 1e-4), mirrored_share);
  return (0.5 / PI) * b.alpha2 * h_h * h_h / (k * k * smith);
}

// The specular lobe over its Fresnel term.
float lobe_dv(BrdfTerms b, vec3 h, float h_h, float n_l) {
  if (BLINN_PHONG == 0 || b.exponent < 0.0) return ggx_dv(b, h, h_h, n_l);
  const vec3 nxh = cross(b.normal, h);
  return dot(b.normal, h) > 0.0 ? blinn_phong(b.exponent, dot(nxh, nxh) / h_h) : 0.0;
}

// f for light from unit direction l, whose cosine with the normal n_l is positive.
vec3 evaluate_brdf(BrdfTerms b, vec3 l, float n_l) {
  vec3 h = l + b.to_viewer;
  float h_h = dot(h, h);
  float v_h = 0.5 * sqrt(h_h);  // of unit vectors
  if (!(h_h > 1e-8)) {          // light from straight behind: no half vector
    h = b.normal;
    h_h = 1.0;
    v_h = 0.0;
  }
  const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x, grazing = x2 * x2 * x;
  const vec3 f = b.f0 + (b.f90 - b.f0) * grazing;
  const float diffuse_left = 1.0 - (b.f0_max + (b.f90_max - b.f0_max) * grazing);
  return b.diffuse * diffuse_left + f * lobe_dv(b, h, h_h, n_l);
}
