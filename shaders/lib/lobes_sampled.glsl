// Part of lib/image_light.glsl where LOBED: the sky's light on sheen, and sampled_sky() of bases with films, stretched
// facets and light that passes through.
#include "lib/visible_normal.glsl"

// What a viewer sees of facets of a width along each axis, and directions that they reflect it to (Heitz, "Sampling the
// GGX Distribution of Visible Normals", 2018). In the axes of the facets, unit vectors; z is the surface's normal.
struct VisibleFacets {
  vec3 v, stretched, t1, t2;  // to the viewer; the same as the facets' hemisphere shows it, and axes across it
  vec2 alpha;
  float length_v, g1;
};
VisibleFacets visible_facets(vec3 to_viewer, vec2 alpha) {
  const vec3 v = normalize(vec3(to_viewer.xy, max(to_viewer.z, 1e-4)));
  const float length_v = length(vec3(alpha * v.xy, v.z));
  const vec3 stretched = vec3(alpha * v.xy, v.z) / length_v;
  const float across2 = dot(stretched.xy, stretched.xy);
  const vec3 t1 = across2 > 1e-12 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across2) : vec3(1.0, 0.0, 0.0);
  return VisibleFacets(v, stretched, t1, cross(stretched, t1), alpha, length_v, 2.0 * v.z / (v.z + length_v));
}
struct FacetSample {
  vec3 h, l;  // the facet's normal, and the direction that it reflects to
  float v_h;
  float uncovered;  // the part of what the viewer sees that other facets leave to l
  float pdf;        // of l, per steradian; negative: l is below the surface
};
FacetSample sample_facet(VisibleFacets f, vec2 disc) {
  const vec3 h = visible_normal(f.stretched, f.t1, f.t2, f.alpha, disc);
  const float v_h = dot(f.v, h);
  const vec3 l = 2.0 * v_h * h - f.v;
  if (l.z <= 0.0 || v_h <= 0.0) return FacetSample(h, l, v_h, 0.0, -1.0);
  const float g2 = 2.0 * l.z * f.v.z / (l.z * f.length_v + f.v.z * length(vec3(f.alpha * l.xy, l.z)));
  const float area = f.alpha.x * f.alpha.y;
  const vec3 q = vec3(h.x * f.alpha.y, h.y * f.alpha.x, h.z * area) / area;
  const float k = dot(q, q);
  return FacetSample(h, l, v_h, g2 / f.g1, f.g1 / (4.0 * PI * area * k * k * f.v.z));
}

// The sky's light on white sheen. What its wide lobe gathers is told by a few directions, evenly spread, each as wide
// as its fraction; bright spots are lights. Their weights are made to sum to the lobe's albedo.
vec3 sheen_of_sky(BrdfTerms b) {
  const bool is_sampled = IBL_METHOD == ibl_sampled;
  const uint count = is_sampled ? frame.image_light.pixel_samples : 16u;
  const mat3 axes = axes_about(b.normal);
  const float albedo = sheen_albedo(b.lobes.sheen_roughness, b.n_v), slice = slice_of_roughness(0.5);
  // Its slices hold the bright spots.
  if (IBL_METHOD == ibl_split) return albedo * filtered_sky(b.normal, slice_of_roughness(1.0));
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const float z = (float(i) + 0.5) / float(count), phi = 2.3999632 * float(i), across = sqrt(1.0 - z * z);
    const vec3 l = axes * vec3(across * cos(phi), across * sin(phi), z), h = l + b.to_viewer;
    const float weight = sheen_lobe(b, h, max(dot(h, h), 1e-8), z);
    sum += weight * (is_sampled ? sky_through(l, 2.0 * PI / float(count)).rest : filtered_sky(l, slice));
    weights += weight;
  }
  sum *= albedo / max(weights, 1e-20);
  const float fraction = is_sampled ? 1.0 : share_of_lights(slice);
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float n_l = dot(b.normal, light.direction);
    const vec3 h = light.direction + b.to_viewer;
    if (n_l > 0.0) sum += fraction * light.illuminance * sheen_lobe(b, h, max(dot(h, h), 1e-8), n_l);
  }
  return sum;
}
// Of what the sheen leaves to the base by the viewer's direction alone, the part that it leaves by the light's too.
float sheen_leaves(BrdfTerms b, float n_l) {
  if (!HAS_SHEEN || b.lobes.sheen_most == 0.0) return 1.0;
  return under_sheen(b, n_l) / max(1.0 - b.lobes.sheen_takes, 1e-6);
}
SkyLobes sampled_sky(BrdfTerms b, vec3 facing, float roughness) {
  const bool is_stretched = HAS_ANISOTROPY && b.lobes.tangent_alpha > 0.0;
  const mat3 facing_axes = axes_about(facing);
  mat3 axes = axes_about(b.normal);
  vec2 alpha = vec2(b.alpha);
  if (is_stretched) {
    axes = mat3(b.lobes.tangent, b.lobes.bitangent, b.normal);
    alpha.x = b.lobes.tangent_alpha;
  }
  const VisibleFacets facets = visible_facets(b.to_viewer * axes, alpha);
  const vec3 v = facets.v;
  const uint count = frame.image_light.pixel_samples;
  const float slice = slice_of_roughness(roughness), fraction = share_of_lights(slice);
  SkyLobes sum = SkyLobes(vec3(0.0), vec3(0.0), vec3(0.0));
  for (uint i = 0u; i < count; ++i) {
    const float u = (float(i) + 0.5) / float(count), phi = 2.0 * PI * float(bitfieldReverse(i)) * (1.0 / 4294967296.0);
    const vec2 disc = sqrt(u) * vec2(cos(phi), sin(phi));
    // Diffuse, of both sides.
    const vec3 l = vec3(disc, sqrt(max(1.0 - u, 0.0)));
    const float left = (1.0 - base_fresnel(b, 0.5 * length(l + v)).dielectric) * sheen_leaves(b, l.z);
    const float covered = PI / (float(count) * l.z);
    if (b.diffuse != vec3(0.0) && l.z > 0.0)
      sum.diffuse += left * b.diffuse * sky_through(facing_axes * l, covered).rest;
    if (HAS_PASSING && b.lobes.passing != vec3(0.0) && l.z > 0.0)
      sum.diffuse += left * b.lobes.passing * sky_through(facing_axes * vec3(l.xy, -l.z), covered).rest;
    // Specular.
    const FacetSample facet = sample_facet(facets, disc);
    if (facet.pdf < 0.0) continue;
    const SkyTexels sky = sky_through(axes * facet.l, 1.0 / (float(count) * facet.pdf));
    const float weight =
        sampled_weight(b, facet.uncovered, facet.pdf, facet.h, facet.l.z) * sheen_leaves(b, facet.l.z);
    sum.specular += base_fresnel(b, facet.v_h).specular * weight * mix(sky.all, sky.rest, fraction);
  }
  sum.diffuse *= PI / float(count);
  sum.specular /= float(count);
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float n_l = dot(facing, light.direction);
    const vec3 mirrored = n_l < 0.0 ? light.direction - 2.0 * n_l * facing : light.direction;
    const float left =
        (1.0 - base_fresnel(b, 0.5 * length(mirrored + b.to_viewer)).dielectric) * sheen_leaves(b, n_l);
    if (n_l > 0.0) sum.diffuse += b.diffuse * light.illuminance * (left * n_l);
    if (HAS_PASSING && n_l < 0.0) sum.diffuse += b.lobes.passing * light.illuminance * (left * -n_l);
  }
  sum.lights = sky_lights(b, slice);
  return sum;
}
