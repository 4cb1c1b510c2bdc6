// Ambient light of surfaces with lobes. Part of lib/ambient.glsl where LOBED.
//
// Under a sky image each lobe takes it as wide as it is, with method `sampled` as exactly as samples are many.
// Approximate in the others, beside what the base's own are: iridescence by the mean over eight facets that the viewer
// sees; stretched facets by some directions, each as wide as its fraction (Colbert and Krivanek, "GPU-Based Importance
// Sampling", 2007); sheen by sixteen directions; light from behind as occluded as that in front, and the base below
// sheen by the viewer's direction alone. Under harmonics alone: the film at the cosine to the viewer, stretched facets
// as round ones of the mean width, sheen by its albedo and the light about the normal. The coat reflects as the base
// does, by its own normal and roughness.

// coat: its specular and lights.
AmbientLobes layered_lobes(Surface s, BrdfTerms b, AmbientLobes base, AmbientLobes coat, float open) {
  const BrdfLobes o = b.lobes;
  const float under = (1.0 - o.sheen_takes) * (1.0 - o.coat_takes);
  AmbientLobes lobes = AmbientLobes(base.diffuse * under, base.specular * under, base.lights * under);
  if (HAS_SHEEN && o.sheen != vec3(0.0)) {
    vec3 light;
    if (IBL_METHOD == 0) {
      light = sheen_albedo(o.sheen_roughness, b.n_v) * ambient_radiance(s.normal);
    } else {
      BrdfTerms in_image = b;
      in_image.normal = in_sky(b.normal);
      in_image.to_viewer = in_sky(b.to_viewer);
      light = frame.sky_intensity * sheen_of_sky(in_image);
    }
    lobes.specular += o.sheen * (light * open);
  }
  if (HAS_COAT) {
    lobes.specular += coat.specular;
    lobes.lights += coat.lights;
  }
  return lobes;
}
AmbientLobes coat_of_sky(Surface s, BrdfTerms b) {
  if (!HAS_COAT || b.lobes.coat_takes == 0.0) return AmbientLobes(vec3(0.0), vec3(0.0), vec3(0.0));
  const Surface coat = coat_surface(s);
  AmbientLobes lobes = whole_sky_lobes(coat, coat_terms(b), coat.normal);
  if (PROBE_COUNT != 0) {
    lobes.specular *= probes.left;
    lobes.lights *= probes.left;
  }
  return lobes;
}
// Of the sky through stretched facets, in its own axes, by directions that the viewer's visible normals give (Heitz
// 2018). Without bright spots, which are lights.
vec3 stretched_sky(BrdfTerms b) {
  const uint count = frame.image_light.pixel_samples;
  const mat3 axes = mat3(b.lobes.tangent, b.lobes.bitangent, b.normal);
  const VisibleFacets facets = visible_facets(b.to_viewer * axes, vec2(b.lobes.tangent_alpha, b.alpha));
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < count; ++i) {
    const float u = (float(i) + 0.5) / float(count), phi = 2.3999632 * float(i);
    const FacetSample facet = sample_facet(facets, sqrt(u) * vec2(cos(phi), sin(phi)));
    if (facet.pdf < 0.0) continue;
    // The round lobe about a mirror direction that is as wide.
    const float round_alpha = sqrt(1.0 / (float(count) * facet.pdf * 4.0 * PI));
    const float slice = max(slice_of_roughness(sqrt(min(round_alpha, 1.0))), float(sky_lights_from));
    sum += base_fresnel(b, facet.v_h).specular * facet.uncovered * filtered_sky(axes * facet.l, slice);
  }
  return sum / float(count);
}
BrdfTerms turned_to_sky(BrdfTerms b) {
  b.normal = in_sky(b.normal);
  b.to_viewer = in_sky(b.to_viewer);
  b.lobes.tangent = in_sky(b.lobes.tangent);
  b.lobes.bitangent = in_sky(b.lobes.bitangent);
  return b;
}
AmbientLobes base_of_sky(Surface s, BrdfTerms b, vec3 facing) {
  if (IBL_METHOD != ibl_sampled) b = under_film(b, IBL_METHOD != 0);
  const Surface round = with_round_facets(s);
  AmbientLobes lobes = whole_sky_lobes(round, b, facing);
  if (HAS_ANISOTROPY && s.lobes.anisotropy > 0.0 && IBL_METHOD != ibl_sampled) {
    if (IBL_METHOD == 0) {
      // As much of an even sky as stretched facets with their gain: a white metal all of it.
      const vec2 albedo = split_sum(round.roughness, clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0)).xy;
      lobes.specular /= (1.0 + facets_further_bounces(s, b)) * (albedo.x + albedo.y);
    } else {
      const BrdfTerms in_image = turned_to_sky(b);
      lobes.specular = frame.sky_intensity * stretched_sky(in_image);
      lobes.lights = frame.sky_intensity * sky_lights(in_image, float(sky_lights_from));
    }
  }
  if (PROBE_COUNT != 0) {
    lobes.specular *= probes.left;
    lobes.lights *= probes.left;
  }
  return lobes;
}

// Without what probes give instead (shade_probes() goes before).
AmbientLobes ambient_lobes(Surface s, BrdfTerms b, vec3 facing) {
  return layered_lobes(s, b, base_of_sky(s, b, facing), coat_of_sky(s, b), 1.0);
}
vec3 ambient_light(Surface s, BrdfTerms b) {
  const AmbientLobes lobes = ambient_lobes(s, b, s.normal);
  return (lobes.diffuse + (lobes.specular + lobes.lights)) * s.occlusion;
}
AmbientLobes occluded_lobes(Surface s, BrdfTerms b, Openness o, vec3 plane_normal) {
  const vec3 facing = OCCLUSION_IS_BENT ? bent_about(s.normal, o.bent, plane_normal) : s.normal;
  know_openness(o, plane_normal);
  AmbientLobes base = base_of_sky(s, b, facing);
  base.diffuse *= o.diffuse;
  const float of_base = reflected_open(o, with_round_facets(s), b.to_viewer, plane_normal);
  base.specular *= of_base;
  base.lights *= reflected_lights_open(o, of_base);
  AmbientLobes coat = coat_of_sky(s, b);
  if (HAS_COAT) {
    o.lobe = -1.0;  // the base's
    const float of_coat = reflected_open(o, coat_surface(s), b.to_viewer, plane_normal);
    coat.specular *= of_coat;
    coat.lights *= reflected_lights_open(o, of_coat);
  }
  return layered_lobes(s, b, base, coat, o.fraction);
}
vec3 occluded_ambient_light(Surface s, BrdfTerms b, Openness o, vec3 plane_normal) {
  const AmbientLobes lobes = occluded_lobes(s, b, o, plane_normal);
  return (lobes.diffuse + (lobes.specular + lobes.lights)) * s.occlusion;
}
