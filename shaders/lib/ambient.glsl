// Ambient light: of a sky image, filtered (lib/image_light.glsl), or else of the spherical harmonics up to l = 2
// (Ramamoorthi and Hanrahan 2001) of the environment or of the neutral default, whose reflections are as blurred as
// diffuse light is. Needs lib/brdf.glsl.
#include "lib/image_light.glsl"
#include "lib/openness.glsl"
// Scale of f0, bias of f90, and what the half vectors' Schlick term takes of a diffuse lobe (sky/split_sum.h).
vec3 split_sum(float roughness, float n_v) {
  const vec2 size = vec2(split_sum_columns, split_sum_rows);
  const float low = sqrt(least_roughness);
  const vec2 at = vec2(sqrt(n_v), (sqrt(max(roughness, least_roughness)) - low) / (1.0 - low));
  return textureLod(sampler2D(textures[frame.split_sum_texture], samplers[frame.split_sum_sampler]),
      (at * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

// The same of a surface's own lobe.
vec3 specular_albedo(Surface s, float n_v) {
  if (BLINN_PHONG != 0 && !s.has_facets)
    return vec3(blinn_phong_albedo(exponent_of_roughness(s.roughness), n_v), 0.0, 0.0);
  return split_sum(s.roughness, n_v);
}

#include "lib/probes.glsl"

// By the lobes that reflect it, without the material's occlusion. Of the sky.
struct AmbientLobes {
  vec3 diffuse, specular;
  vec3 lights;  // reflections of its bright spots, where these are lights of their own: not in `specular`
};
// What two cones share of the smaller one; half angles and the angle between their axes in radians (Oat and Sander,
// "Ambient Aperture Lighting", 2007).
float cones_share(float a, float b, float between) {
  const float apart = abs(a - b);
  return smoothstep(0.0, 1.0, 1.0 - clamp((between - apart) / max(a + b - apart, 1e-4), 0.0, 1.0));
}
// Half angle of the cone that a lobe is taken for (Jimenez, Wu, Pesce, Jarabo 2016), radians.
float lobe_cone(float roughness) { return max(acos(exp2(-3.32193 * roughness * roughness)), 0.02); }
// How open the part of a lobe is that f90 scales, which leans towards the horizon: as far as it lies in the cone about
// the normal that sky_fraction leaves. d: its middle.
float grazing_open(vec3 normal, vec3 d, float roughness) {
  if (sky_fraction >= 1.0) return 1.0;
  const float lobe = lobe_cone(roughness);
  const float between = acos(clamp(dot(normal, d), -1.0, 1.0));
  const float all = cones_share(0.5 * PI, lobe, between);
  return clamp(cones_share(sky_cone(), lobe, between) / max(all, 1e-3), 0.0, 1.0);
}
// facing: the direction about which diffuse light is gathered; the normal where nothing is hidden.
AmbientLobes whole_sky_lobes(Surface s, BrdfTerms b, vec3 facing) {
  BrdfTerms in_image = b;
  in_image.normal = in_sky(b.normal);
  in_image.to_viewer = in_sky(b.to_viewer);
#ifdef LOBED
  in_image.lobes.tangent = in_sky(b.lobes.tangent);
  in_image.lobes.bitangent = in_sky(b.lobes.bitangent);
#endif
  if (IBL_METHOD == ibl_sampled) {
    const SkyLobes sampled = sampled_sky(in_image, in_sky(facing), s.roughness);
    return AmbientLobes(sampled.diffuse * frame.sky_intensity, sampled.specular * frame.sky_intensity,
        sampled.lights * frame.sky_intensity);
  }
  const vec3 albedo = specular_albedo(s, clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0));
  const float diffuse_left = 1.0 - (b.f0_max + (b.f90_max - b.f0_max) * albedo.z);
  const vec3 around = HAS_SKY_IRRADIANCE != 0 ? frame.sky_intensity * sky_irradiance(in_sky(facing))
                                              : ambient_radiance(facing);
#ifdef SCATTERS
  vec3 diffuse = s.lobes.front * diffuse_left * (1.0 - s.metallic) * around;
#elif defined(LOBED)
  vec3 diffuse = s.base_color * diffuse_left * (1.0 - s.metallic) * (1.0 - s.lobes.passing) * around;
#endif
#ifdef LOBED
  if (HAS_PASSING && b.lobes.passing != vec3(0.0)) {
    const vec3 behind =
        HAS_SKY_IRRADIANCE != 0 ? frame.sky_intensity * sky_irradiance(in_sky(-facing)) : ambient_radiance(-facing);
    diffuse += PI * b.lobes.passing * diffuse_left * behind;
  }
#else
  const vec3 diffuse = s.base_color * diffuse_left * (1.0 - s.metallic) * around;
#endif
  vec3 specular = b.f0 * albedo.x + b.f90 * albedo.y, lights = vec3(0.0);
#ifdef LOBED
  const vec3 mirrored = reflect(-b.to_viewer, s.lobes.mirroring);
#else
  const vec3 mirrored = reflect(-b.to_viewer, s.normal);
#endif
  if (IBL_METHOD == ibl_split) {
    specular *= frame.sky_intensity * filtered_sky(in_sky(mirrored), slice_of_roughness(s.roughness));
  } else if (IBL_METHOD == ibl_lobe) {
    const vec4 lobe = lobe_shape(frame.image_light.lobe_texture, frame.image_light.clamp_sampler, s.roughness,
        clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0));
    const float sharp = MIRROR_TAPS != 0 && mirror_known ? mirror_share(slice_of_roughness(s.roughness)) : 0.0;
    vec3 sky = vec3(0.0);
    if (sharp < 1.0) {
      const vec3 of_f0 = filtered_sky(in_sky(normalize(mix(s.normal, mirrored, lobe.x))), lobe.y);
      const vec3 grazing = normalize(mix(s.normal, mirrored, lobe.z));
      const vec3 of_f90 = filtered_sky(in_sky(grazing), lobe.w) * grazing_open(s.normal, grazing, s.roughness);
      sky = (1.0 - sharp) * (b.f0 * albedo.x * of_f0 + b.f90 * albedo.y * of_f90);
    }
    if (MIRROR_TAPS != 0 && sharp > 0.0)
      sky += sharp * specular * mirrored_sky(in_sky(mirrored), in_sky(mirror_across), in_sky(mirror_down), b.alpha);
    specular = sky * frame.sky_intensity;
    lights = sky_lights(in_image, lobe.y) * frame.sky_intensity;
  } else {
    specular *= ambient_radiance(mirrored);
  }
  return AmbientLobes(diffuse, specular, lights);
}
#ifndef LOBED
// Without what probes give instead (shade_probes() goes before).
AmbientLobes ambient_lobes(Surface s, BrdfTerms b, vec3 facing) {
  AmbientLobes lobes = whole_sky_lobes(s, b, facing);
  if (PROBE_COUNT != 0) {
    lobes.specular *= probes.left;
    lobes.lights *= probes.left;
  }
  return lobes;
}
vec3 ambient_light(Surface s, BrdfTerms b) {
  const AmbientLobes lobes = ambient_lobes(s, b, s.normal);
  return (lobes.diffuse + (lobes.specular + lobes.lights)) * s.occlusion;
}
#endif
// What is left of the lobes where a fraction `open` of the sky's diffuse light arrives. Reflections by Lagarde and de
// Rousiers, "Moving Frostbite to Physically Based Rendering", 2014: a smooth surface loses them later than a rough one
// its light.
float specular_open(float open, float n_v, float roughness) {
  return clamp(pow(clamp(n_v, 0.0, 1.0) + open, exp2(-16.0 * roughness - 1.0)) - 1.0 + open, 0.0, 1.0);
}
// By how much more or less of the lobe is open where what is open leans: what is open is a cone, about the mean open
// direction against about the normal, the lobe another about the mirror direction (cones after Jimenez, Wu, Pesce,
// Jarabo 2016). 1 where it does not lean, and towards 1 where both cones miss the lobe, of which they then say nothing.
float open_by_leaning(vec3 bent, float open, vec3 normal, vec3 v, float roughness) {
  const float say_nothing = 0.1;
  const vec3 mirrored = reflect(-v, normal);
  const float lobe = lobe_cone(roughness);
  const float cone = acos(sqrt(clamp(1.0 - open, 0.0, 1.0)));
  const float upright = cones_share(cone, lobe, acos(clamp(dot(normal, mirrored), -1.0, 1.0)));
  const float leaning = cones_share(cone, lobe, acos(clamp(dot(bent, mirrored), -1.0, 1.0)));
  return (leaning + say_nothing) / (upright + say_nothing);
}
// For a shading normal: bent as far off it as the triangle's is bent.
vec3 bent_about(vec3 normal, vec3 bent, vec3 plane_normal) {
  const vec3 turned = normal + (bent - plane_normal);
  return dot(turned, turned) > 1e-6 ? normalize(turned) : normal;
}
float reflected_open(Openness o, Surface s, vec3 v, vec3 plane_normal) {
  if (o.lobe >= 0.0) return o.lobe;
  // A smooth surface mirrors what lies in one direction, a rough one all that is open.
  float open = specular_open(o.fraction, dot(s.normal, v), s.roughness);
  if (o.mirror >= 0.0) open = mix(o.mirror, open, s.roughness);
  if (!OCCLUSION_IS_BENT) return open;
  const vec3 bent = bent_about(s.normal, o.bent, plane_normal);
  return clamp(open * open_by_leaning(bent, o.fraction, s.normal, v, s.roughness), 0.0, 1.0);
}
// What the lobes of the sky need of it themselves.
void know_openness(Openness o, vec3 plane_normal) {
  sky_lights_plane = plane_normal;
  sky_fraction = o.mirror < 0.0 && o.lobe < 0.0 ? o.fraction : 1.0;
}
// The same of its bright spots.
float reflected_lights_open(Openness o, float of_rest) { return o.lights >= 0.0 ? o.lights : of_rest; }
#ifdef LOBED
#include "lib/lobes_ambient.glsl"
#else
AmbientLobes occluded_lobes(Surface s, BrdfTerms b, Openness o, vec3 plane_normal) {
  const vec3 facing = OCCLUSION_IS_BENT ? bent_about(s.normal, o.bent, plane_normal) : s.normal;
  know_openness(o, plane_normal);
  const AmbientLobes lobes = ambient_lobes(s, b, facing);
  const float open = reflected_open(o, s, b.to_viewer, plane_normal);
  return AmbientLobes(lobes.diffuse * o.diffuse, lobes.specular * open, lobes.lights * reflected_lights_open(o, open));
}
vec3 occluded_ambient_light(Surface s, BrdfTerms b, Openness o, vec3 plane_normal) {
  const AmbientLobes lobes = occluded_lobes(s, b, o, plane_normal);
  return (lobes.diffuse + (lobes.specular + lobes.lights)) * s.occlusion;
}
#endif
