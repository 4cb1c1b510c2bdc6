#pragma once
// The sky from a direction: of a sky image, as it was filtered (sky/prefilter_sky.h), in the sky's own axes; or by
// spherical harmonics up to l = 2, about the world's axes. Needs lib/bindless.glsl, lib/frame.glsl, lib/features.glsl.
#include "lib/pi.glsl"

// Place on an octahedral map from -1 to 1, +Y in the middle (Engelhardt and Dachsbacher 2008).
vec2 octahedral(vec3 d) {
  d /= abs(d.x) + abs(d.y) + abs(d.z);
  if (d.y >= 0.0) return d.xz;
  return (1.0 - abs(d.zx)) * vec2(d.x >= 0.0 ? 1.0 : -1.0, d.z >= 0.0 ? 1.0 : -1.0);
}
vec3 sky_slice(uint i, vec2 place) {
  const SkySlice slice = SkySlicesRef(frame.image_light.slices).s[i];
  return textureLod(sampler2D(textures[frame.image_light.texture], samplers[frame.image_light.clamp_sampler]),
      slice.offset + slice.scale * place, 0.0).rgb;
}
vec3 filtered_sky(vec3 d, float slice) {
  const vec2 place = octahedral(d) * 0.5 + 0.5;
  const uint i = min(uint(slice), sky_slice_count - 2u);
  return mix(sky_slice(i, place), sky_slice(i + 1u, place), slice - float(i));
}
vec3 sky_irradiance(vec3 n) {
  const vec2 place = octahedral(n) * 0.5 + 0.5;
  const vec2 uv = frame.image_light.irradiance_uv.x + frame.image_light.irradiance_uv.y * place;
  return textureLod(
      sampler2D(textures[frame.image_light.irradiance_texture], samplers[frame.image_light.clamp_sampler]), uv,
      0.0).rgb;
}

// The sky's image itself, seen through a cone of a solid angle, and that without its bright spots.
struct SkyTexels {
  vec3 all, rest;
};
SkyTexels sky_through(vec3 d, float solid_angle) {
  const float across = length(d.xz);
  const vec2 uv = vec2(atan(d.z, d.x) / (2.0 * PI) + 0.5, acos(clamp(d.y, -1.0, 1.0)) / PI);
  const vec2 size = frame.sky_size_px, rest_size = frame.image_light.rest_px;
  const float covered = solid_angle / (2.0 * PI * PI * max(across, 1e-4));  // as an image of one texel
  const float lod = max(0.5 * log2(max(covered * size.x * size.y, 1e-12)), 0.0);
  const float rest_lod = max(0.5 * log2(max(covered * rest_size.x * rest_size.y, 1e-12)), 0.0);
  return SkyTexels(
      textureLod(sampler2D(textures[frame.sky_texture], samplers[frame.sky_sampler]), uv, lod).rgb,
      textureLod(sampler2D(textures[frame.image_light.texture], samplers[frame.sky_sampler]), uv, rest_lod).rgb);
}

// Of the environment, or of the neutral default: as blurred as diffuse light is.
vec3 ambient_radiance(vec3 n) {
  const vec4 sh[9] = frame.ambient_sh;
  vec3 e = sh[0].rgb * 0.282095 + sh[1].rgb * (0.488603 * n.y) + sh[2].rgb * (0.488603 * n.z) +
           sh[3].rgb * (0.488603 * n.x) + sh[4].rgb * (1.092548 * n.x * n.y) + sh[5].rgb * (1.092548 * n.y * n.z) +
           sh[6].rgb * (0.315392 * (3.0 * n.z * n.z - 1.0)) +
           sh[7].rgb * (1.092548 * n.x * n.z) + sh[8].rgb * (0.546274 * (n.x * n.x - n.y * n.y));
  return max(e, vec3(0.0));
}

// How bright the sky is from a direction of the world, for rays that stand for a solid angle; without its bright spots.
float sky_brightness(vec3 d, float solid_angle) {
  const float slice = 9.0;  // as wide as rays by the cosine can tell: a lobe of roughness 0.31
  vec3 sky;
  if (IBL_METHOD == ibl_sampled)
    sky = sky_through(in_sky(d), solid_angle).rest;
  else if (IBL_METHOD != 0)
    sky = filtered_sky(in_sky(d), slice);
  else
    sky = ambient_radiance(d);
  return clamp(dot(sky, vec3(0.2126, 0.7152, 0.0722)), 0.0, 1e30);
}
// The same with its bright spots, as sharp as a surface of a roughness tells.
float sky_reflected(vec3 d, float solid_angle, float roughness) {
  vec3 sky;
  if (IBL_METHOD == ibl_sampled)
    sky = sky_through(in_sky(d), solid_angle).all;
  else if (IBL_METHOD != 0)
    sky = filtered_sky(in_sky(d), 9.0 * min(roughness / 0.31, 1.0));
  else
    sky = ambient_radiance(d);
  return clamp(dot(sky, vec3(0.2126, 0.7152, 0.0722)), 0.0, 1e30);
}
