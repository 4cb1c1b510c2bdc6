// Part of lib/brdf.glsl where LOBED, after BrdfTerms.
#include "lib/visible_normal.glsl"

// Width along the tangent: facets are stretched from alpha towards 1.
float stretched_alpha(float alpha, float anisotropy) { return mix(alpha, 1.0, anisotropy * anisotropy); }
// Roughness of round facets that stand for stretched ones seen from anywhere (reference/albedo.h).
float mean_roughness(Surface s) {
  const float r = max(s.roughness, least_roughness), alpha = r * r;
  if (!HAS_ANISOTROPY || s.lobes.anisotropy == 0.0) return s.roughness;
  const float along = stretched_alpha(alpha, s.lobes.anisotropy);
  return sqrt(sqrt(0.39 * along * along + 0.61 * alpha * alpha));
}
// What further bounces add to white facets; to stretched ones as to round ones that lose as much light towards the
// viewer, by the fit of reference/albedo.h.
float facets_further_bounces(Surface s, BrdfTerms b) {
  if (!HAS_ANISOTROPY || s.lobes.anisotropy == 0.0) return further_bounces(b.alpha, b.n_v / b.smith_v);
  const float along = stretched_alpha(b.alpha, s.lobes.anisotropy), v_y = dot(s.lobes.bitangent, b.to_viewer);
  const vec3 stretched = normalize(vec3(along * dot(s.lobes.tangent, b.to_viewer), b.alpha * v_y, b.n_v));
  const float part = 0.431 + 0.177 * abs(stretched.y) - 0.085 * b.alpha / along * v_y * v_y +
                     (1.0 - along) * (0.168 - 0.35 * abs(stretched.x));
  return further_bounces(sqrt(part * along * along + (1.0 - part) * b.alpha2), stretched.z);
}

BrdfLobes brdf_lobes(Surface s, BrdfTerms b, vec3 gain) {
  BrdfLobes o;
  o.coat_takes = s.lobes.coat_takes;
  o.coat_normal = s.lobes.coat_normal;
  const float coat_roughness = max(s.lobes.coat_roughness, least_roughness);
  o.coat_n_v = max(abs(dot(s.lobes.coat_normal, b.to_viewer)), 1e-4);
  o.coat_alpha = coat_roughness * coat_roughness;
  o.coat_alpha2 = o.coat_alpha * o.coat_alpha;
  o.coat_smith_v = sqrt(o.coat_n_v * o.coat_n_v * (1.0 - o.coat_alpha2) + o.coat_alpha2);
  o.sheen = vec3(0.0);
  o.sheen_most = o.sheen_takes = o.sheen_alpha = o.sheen_lambda_v = 0.0;
  o.sheen_roughness = s.lobes.sheen_roughness;
  if (HAS_SHEEN && s.lobes.sheen != vec3(0.0)) {
    const float albedo = sheen_albedo(s.lobes.sheen_roughness, b.n_v);
    o.sheen = s.lobes.sheen * ((1.0 - o.coat_takes) / max(albedo, 1.0));
    o.sheen_most = largest(s.lobes.sheen);
    o.sheen_takes = o.sheen_most * min(albedo, 1.0);
    o.sheen_alpha = sheen_alpha(s.lobes.sheen_roughness);
    o.sheen_lambda_v = sheen_lambda(b.n_v, o.sheen_alpha);
  }
  o.film = s.lobes.film;
  o.film_ior = s.lobes.film_ior;
  o.film_nm = s.lobes.film_nm;
  o.dielectric_f0 = s.dielectric_f0;
  o.metal_f0 = s.base_color;
  o.gain = gain;
  o.dielectric_f90 = s.dielectric_f90;
  o.metallic = s.metallic;
  o.tangent = s.lobes.tangent;
  o.bitangent = s.lobes.bitangent;
  o.tangent_alpha = o.smith_v = 0.0;
  if (HAS_ANISOTROPY && s.lobes.anisotropy > 0.0) {
    o.tangent_alpha = stretched_alpha(b.alpha, s.lobes.anisotropy);
    o.smith_v =
        length(vec3(o.tangent_alpha * dot(o.tangent, b.to_viewer), b.alpha * dot(o.bitangent, b.to_viewer), b.n_v));
  }
  o.passing = s.lobes.passing_color * (s.lobes.passing * (1.0 - s.metallic) / PI);
#ifdef SCATTERS
  o.slab_m = s.lobes.slab_m;
#endif
  return o;
}

// The base's Fresnel term with what further bounces add, and the strongest channel of the dielectric's.
struct BaseFresnel {
  vec3 specular;
  float dielectric;
};
BaseFresnel base_fresnel(BrdfTerms b, float v_h) {
  const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x, grazing = x2 * x2 * x;
  BaseFresnel f = BaseFresnel(b.f0 + (b.f90 - b.f0) * grazing, b.f0_max + (b.f90_max - b.f0_max) * grazing);
  const BrdfLobes o = b.lobes;
  if (HAS_FILM && o.film > 0.0) {
    const vec3 dielectric = film_reflectance(v_h, o.film_ior, o.film_nm, o.dielectric_f0);
    const vec3 metal = film_reflectance(v_h, o.film_ior, o.film_nm, o.metal_f0);
    f.specular = mix(f.specular, mix(dielectric, metal, o.metallic) * o.gain, o.film);
    f.dielectric = largest(mix(o.dielectric_f0 + (o.dielectric_f90 - o.dielectric_f0) * grazing, dielectric, o.film));
  }
  return f;
}

// D V of the base's facets, round or stretched.
float base_dv(BrdfTerms b, vec3 l, vec3 h, float h_h, float n_l) {
  const BrdfLobes o = b.lobes;
  if (!HAS_ANISOTROPY || o.tangent_alpha == 0.0) return lobe_dv(b, h, h_h, n_l);
  const float at = o.tangent_alpha, ab = b.alpha;
  const vec3 q = vec3(dot(o.tangent, h) * ab, dot(o.bitangent, h) * at, dot(b.normal, h) * (at * ab));
  const float k = dot(q, q) / (at * ab);  // times at ab
  const float smith =
      n_l * o.smith_v + b.n_v * length(vec3(at * dot(o.tangent, l), ab * dot(o.bitangent, l), n_l)) + 1e-7;
  return (0.5 / PI) * (at * ab) * h_h * h_h / (k * k * smith);
}

BrdfTerms coat_terms(BrdfTerms b) {
  BrdfTerms c = b;
  c.normal = b.lobes.coat_normal;
  c.n_v = b.lobes.coat_n_v;
  c.smith_v = b.lobes.coat_smith_v;
  c.alpha = b.lobes.coat_alpha;
  c.alpha2 = b.lobes.coat_alpha2;
  c.exponent = -1.0;
  c.f0 = c.f90 = vec3(b.lobes.coat_takes);
  c.diffuse = vec3(0.0);
  c.f0_max = c.f90_max = 0.0;
  c.lobes.tangent_alpha = c.lobes.film = 0.0;
  return c;
}

// What the sheen leaves to the base of light with that cosine.
float under_sheen(BrdfTerms b, float n_l) {
  if (!HAS_SHEEN || b.lobes.sheen_most == 0.0) return 1.0;
  const float to_light = b.lobes.sheen_most * min(sheen_albedo(b.lobes.sheen_roughness, abs(n_l)), 1.0);
  return 1.0 - max(b.lobes.sheen_takes, to_light);
}

// f n.l of white sheen, for the half vector h of any length but zero.
float sheen_lobe(BrdfTerms b, vec3 h, float h_h, float n_l) {
  const vec3 nxh = cross(b.normal, h);
  const float inverse = 1.0 / b.lobes.sheen_alpha, sine2 = clamp(dot(nxh, nxh) / h_h, 0.0, 1.0);
  const float d = (2.0 + inverse) * pow(max(sine2, 1e-20), 0.5 * inverse) / (2.0 * PI);
  return d / (4.0 * b.n_v * (1.0 + b.lobes.sheen_lambda_v + sheen_lambda(n_l, b.lobes.sheen_alpha)));
}

// f times the cosine for light from unit direction l: what reflects it, and what lets it through from behind the
// shading normal.
struct LobesLit {
  vec3 front, through;
};
LobesLit evaluate_lobes(BrdfTerms b, vec3 l) {
  const BrdfLobes o = b.lobes;
  const float n_l = dot(b.normal, l);
  LobesLit lit = LobesLit(vec3(0.0), vec3(0.0));
  if (n_l > 0.0 || (HAS_PASSING && n_l < 0.0 && o.passing != vec3(0.0))) {
    vec3 h = (n_l > 0.0 ? l : l - 2.0 * n_l * b.normal) + b.to_viewer;
    float h_h = dot(h, h), v_h = 0.5 * sqrt(h_h);
    if (!(h_h > 1e-8)) {
      h = b.normal;
      h_h = 1.0;
      v_h = 0.0;
    }
    const BaseFresnel f = base_fresnel(b, v_h);
    const float under = under_sheen(b, n_l) * (1.0 - o.coat_takes) * abs(n_l);
    if (n_l > 0.0) {
      lit.front = (b.diffuse * (1.0 - f.dielectric) + f.specular * base_dv(b, l, h, h_h, n_l)) * under;
      if (HAS_SHEEN && o.sheen != vec3(0.0)) lit.front += o.sheen * sheen_lobe(b, h, h_h, n_l);
    } else {
      lit.through = o.passing * ((1.0 - f.dielectric) * under);
    }
  }
  if (HAS_COAT && o.coat_takes > 0.0) {
    const float coat_l = dot(o.coat_normal, l);
    if (coat_l > 0.0) {
      vec3 h = l + b.to_viewer;
      float h_h = dot(h, h);
      if (!(h_h > 1e-8)) {
        h = o.coat_normal;
        h_h = 1.0;
      }
      lit.front += o.coat_takes * coat_l * ggx_dv(coat_terms(b), h, h_h, coat_l);
    }
  }
  return lit;
}

// The base as light from all around sees it: Fresnel terms of the film, at the cosine to the viewer, or with `facets`
// the mean over those that the viewer sees (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018).
BrdfTerms under_film(BrdfTerms b, bool facets) {
  const BrdfLobes o = b.lobes;
  if (!HAS_FILM || o.film == 0.0) return b;
  const float n_v = clamp(dot(b.normal, b.to_viewer), 1e-4, 1.0);
  const vec3 dielectric = film_reflectance(n_v, o.film_ior, o.film_nm, o.dielectric_f0);
  vec3 mean = mix(dielectric, film_reflectance(n_v, o.film_ior, o.film_nm, o.metal_f0), o.metallic);
  if (facets) {
    const uint count = 8u;
    const vec3 v = vec3(sqrt(1.0 - n_v * n_v), 0.0, n_v);
    const vec3 stretched = normalize(vec3(b.alpha * v.x, 0.0, v.z));
    const vec3 across = vec3(-stretched.z, 0.0, stretched.x);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (uint i = 0u; i < count; ++i) {
      const float u = (float(i) + 0.5) / float(count), phi = 2.3999632 * float(i);
      const vec2 disc = sqrt(u) * vec2(cos(phi), sin(phi));
      const vec3 h = visible_normal(stretched, vec3(0.0, 1.0, 0.0), across, vec2(b.alpha), disc);
      const float v_h = dot(v, h), l_z = 2.0 * v_h * h.z - v.z;
      if (!(l_z > 0.0) || !(v_h > 0.0)) continue;
      const float weight = l_z / (l_z + sqrt(l_z * l_z * (1.0 - b.alpha2) + b.alpha2));  // about g2 / g1
      vec3 f = vec3(0.0);
      if (o.metallic < 1.0) f += (1.0 - o.metallic) * film_reflectance(v_h, o.film_ior, o.film_nm, o.dielectric_f0);
      if (o.metallic > 0.0) f += o.metallic * film_reflectance(v_h, o.film_ior, o.film_nm, o.metal_f0);
      sum += weight * f;
      weights += weight;
    }
    if (weights > 0.0) mean = sum / weights;
  }
  b.f0 = mix(b.f0, mean * o.gain, o.film);
  b.f90 = mix(b.f90, mean * o.gain, o.film);
  b.f0_max = mix(b.f0_max, largest(dielectric), o.film);
  b.f90_max = mix(b.f90_max, largest(dielectric), o.film);
  b.lobes.film = 0.0;
  return b;
}
// The base's surface with round facets that stand for stretched ones.
Surface with_round_facets(Surface s) {
  if (!HAS_ANISOTROPY || s.lobes.anisotropy == 0.0) return s;
  s.roughness = mean_roughness(s);
  return s;
}
// The coat as a surface of its own.
Surface coat_surface(Surface s) {
  s.base_color = vec3(0.0);
  s.metallic = 0.0;
  s.has_facets = true;
  s.roughness = s.lobes.coat_roughness;
  s.normal = s.lobes.mirroring = s.lobes.coat_normal;
  s.lobes.anisotropy = s.lobes.film = s.lobes.passing = 0.0;
#ifdef SCATTERS
  s.lobes.front = vec3(0.0);
  s.lobes.slab_m = 0.0;
#endif
  return s;
}
