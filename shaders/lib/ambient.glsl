// Ambient light: of a sky image, filtered (lib/image_light.glsl), or else of the spherical harmonics up to l = 2
// (Ramamoorthi and Hanrahan 2001) of the environment or of the neutral default, whose reflections are as blurred as
// diffuse light is. Needs lib/brdf.glsl.
#include "lib/image_light.glsl"
vec3 ambient_radiance(vec3 n) {
  const vec4 sh[9] = frame.ambient_sh;
  vec3 e = sh[0].rgb * 0.282095 + sh[1].rgb * (0.488603 * n.y) + sh[2].rgb * (0.488603 * n.z) +
           sh[3].rgb * (0.488603 * n.x) + sh[4].rgb * (1.092548 * n.x * n.y) + sh[5].rgb * (1.092548 * n.y * n.z) +
           sh[6].rgb * (0.315392 * (3.0 * n.z * n.z - 1.0)) +
           sh[7].rgb * (1.092548 * n.x * n.z) + sh[8].rgb * (0.546274 * (n.x * n.x - n.y * n.y));
  return max(e, vec3(0.0));
}
// Scale of f0, bias of f90, and what the half vectors' Schlick term takes of a diffuse lobe (frame/split_sum.h).
vec3 split_sum(float roughness, float n_v) {
  const vec2 size = vec2(split_sum_columns, split_sum_rows);
  const float low = sqrt(least_roughness);
  const vec2 at = vec2(sqrt(n_v), (sqrt(max(roughness, least_roughness)) - low) / (1.0 - low));
  return textureLod(sampler2D(textures[frame.split_sum_texture], samplers[frame.split_sum_sampler]),
      (at * (size - 1.0) + 0.5) / size, 0.0).rgb;
}

#include "lib/probes.glsl"

// By the lobes that reflect it, without the material's occlusion. Of the sky.
struct AmbientLobes {
  vec3 diffuse, specular;
};
AmbientLobes whole_sky_lobes(Surface s, BrdfTerms b) {
  BrdfTerms in_image = b;
  in_image.normal = in_sky(b.normal);
  in_image.to_viewer = in_sky(b.to_viewer);
  if (IBL_METHOD == ibl_sampled) {
    const SkyLobes sampled = sampled_sky(in_image, s.roughness);
    return AmbientLobes(sampled.diffuse * frame.sky_intensity, sampled.specular * frame.sky_intensity);
  }
  const vec3 albedo = split_sum(s.roughness, clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0));
  const float diffuse_left = 1.0 - (b.f0_max + (b.f90_max - b.f0_max) * albedo.z);
  const vec3 around = HAS_SKY_IRRADIANCE != 0 ? frame.sky_intensity * sky_irradiance(in_image.normal)
                                              : ambient_radiance(s.normal);
  const vec3 diffuse = s.base_color * diffuse_left * (1.0 - s.metallic) * around;
  vec3 specular = b.f0 * albedo.x + b.f90 * albedo.y;
  const vec3 mirrored = reflect(-b.to_viewer, s.normal);
  if (IBL_METHOD == ibl_split) {
    specular *= frame.sky_intensity * filtered_sky(in_sky(mirrored), slice_of_roughness(s.roughness));
  } else if (IBL_METHOD == ibl_lobe) {
    const vec2 lobe = lobe_shape(frame.image_light.lobe_texture, frame.image_light.clamp_sampler, s.roughness,
        clamp(dot(s.normal, b.to_viewer), 1e-4, 1.0));
    specular *= filtered_sky(in_sky(normalize(mix(s.normal, mirrored, lobe.x))), lobe.y);
    specular += sky_lights(in_image, lobe.y);
    specular *= frame.sky_intensity;
  } else {
    specular *= ambient_radiance(mirrored);
  }
  return AmbientLobes(diffuse, specular);
}
// left: the share of the reflection that probes leave to the sky.
AmbientLobes ambient_lobes(Surface s, BrdfTerms b, float left) {
  AmbientLobes lobes = whole_sky_lobes(s, b);
  if (PROBE_COUNT != 0) lobes.specular *= left;
  return lobes;
}
LocalLight local_light(Surface s, BrdfTerms b, vec3 at) {
  if (PROBE_COUNT == 0) return LocalLight(vec3(0.0), 1.0);
  return light_of_probes(s, b, at);
}
vec3 ambient_light(Surface s, BrdfTerms b, float left) {
  const AmbientLobes lobes = ambient_lobes(s, b, left);
  return (lobes.diffuse + lobes.specular) * s.occlusion;
}
// What is left of the lobes where a share `open` of the sky's diffuse light arrives. Reflections by Lagarde and de
// Rousiers, "Moving Frostbite to Physically Based Rendering", 2014: a smooth surface loses them later than a rough one
// its light.
float specular_open(float open, float n_v, float roughness) {
  return clamp(pow(clamp(n_v, 0.0, 1.0) + open, exp2(-16.0 * roughness - 1.0)) - 1.0 + open, 0.0, 1.0);
}
AmbientLobes occluded_lobes(AmbientLobes lobes, Surface s, vec3 v, float open) {
  return AmbientLobes(lobes.diffuse * open, lobes.specular * specular_open(open, dot(s.normal, v), s.roughness));
}
vec3 occluded_ambient_light(Surface s, BrdfTerms b, float left, float open) {
  const AmbientLobes lobes = occluded_lobes(ambient_lobes(s, b, left), s, b.to_viewer, open);
  return (lobes.diffuse + lobes.specular) * s.occlusion;
}
