#pragma once
// Light of reflection probes on glossy surfaces: a probe's image, looked up where the lobe's middle leaves the probe's
// box (Lagarde and Zanuttini, "Local Image-based Lighting With Parallax-corrected Cubemaps", 2012). Needs
// lib/ambient.glsl.

// 1 inside the box, falling to 0 outside: what bounds a room lies on the faces of the box that is fitted to it.
float probe_weight(Probe p, vec3 at) {
  const vec3 outside = max(max(p.lowest - at, at - p.highest), vec3(0.0));
  return clamp(1.0 - length(outside) / p.fade_m, 0.0, 1.0);
}
vec3 probe_slice(Probe p, uint i, vec2 place) {
  const SkySlice slice = SkySlicesRef(frame.probes.slices).s[i];
  return textureLod(nonuniformEXT(sampler2D(textures[p.texture], samplers[frame.probes.clamp_sampler])),
      slice.offset + slice.scale * place, 0.0).rgb;
}
// Along the unit direction d.
vec3 probe_radiance(Probe p, vec3 at, vec3 d, float slice) {
  const vec3 from = clamp(at, p.lowest, p.highest);
  const vec3 to_face = mix(p.lowest, p.highest, greaterThan(d, vec3(0.0))) - from;
  const vec3 leaves = mix(vec3(3e38), to_face / d, greaterThan(abs(d), vec3(1e-12)));
  const float away = max(min(leaves.x, min(leaves.y, leaves.z)), 0.0);
  const vec3 met = from + away * d - p.position;
  // What the lobe covers there looks as much wider from the probe as that is nearer to it. A slice's lobe is as wide as
  // its roughness squared.
  const float wider = away / max(length(met), 1e-30);
  const float from_probe = clamp(slice + 0.5 * float(sky_slices_per_octave) * log2(clamp(wider, 1e-6, 1e6)), 0.0,
      float(sky_slice_count - 1u));
  const vec2 place = octahedral(normalize_or(met, d)) * 0.5 + 0.5;
  const uint i = min(uint(from_probe), sky_slice_count - 2u);
  return mix(probe_slice(p, i, place), probe_slice(p, i + 1u, place), from_probe - float(i));
}

// What probes give the shaded point, without the material's occlusion, and the fraction of the sky's reflection that
// they leave.
struct ProbesShaded {
  vec3 specular;
  float left;
#ifdef LOBED
  vec3 base;  // of that, by the base
} probes = ProbesShaded(vec3(0.0), 1.0, vec3(0.0));
#else
} probes = ProbesShaded(vec3(0.0), 1.0);
#endif
// Of the specular lobe of one surface.
vec3 probe_lobe(Surface s, BrdfTerms b, vec3 at) {
  const float n_v = clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0);
  // One lookup for both parts, by what each reflects.
  const vec4 shape = lobe_shape(frame.probes.lobe_texture, frame.probes.clamp_sampler, s.roughness, n_v);
#ifdef LOBED
  const vec3 mirrored = reflect(-b.to_viewer, s.lobes.mirroring);
#else
  const vec3 mirrored = reflect(-b.to_viewer, s.normal);
#endif
  const vec3 albedo = specular_albedo(s, n_v);
  const vec3 first = b.f0 * albedo.x, all = first + b.f90 * albedo.y;
  const float of_all = dot(all, vec3(1.0));
  const vec2 lobe = mix(shape.zw, shape.xy, of_all > 0.0 ? dot(first, vec3(1.0)) / of_all : 1.0);
  const vec3 d = normalize_or(mix(s.normal, mirrored, lobe.x), s.normal);
  vec3 light = vec3(0.0);
  for (int i = 0; i < PROBE_COUNT; ++i) {
    const Probe p = frame.probes.probe[i];
    const float weight = probes.left * probe_weight(p, at);
    if (weight > 0.0) light += weight * probe_radiance(p, at, d, lobe.y);
    probes.left -= weight;
  }
  return light * all;
}
void shade_probes(Surface s, BrdfTerms b, vec3 at) {
  if (PROBE_COUNT == 0) return;
#ifdef LOBED
  vec3 coat = vec3(0.0);
  if (HAS_COAT) coat = probe_lobe(coat_surface(s), coat_terms(b), at);
  probes.left = 1.0;
  const float under = (1.0 - b.lobes.coat_takes) * (1.0 - b.lobes.sheen_takes);
  probes.base = probe_lobe(with_round_facets(s), under_film(b, IBL_METHOD != 0), at) * under;
  probes.specular = coat + probes.base;
#else
  probes.specular = probe_lobe(s, b, at);
#endif
}
