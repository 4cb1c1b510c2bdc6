#version 460
// Light of lamps that the air turns once towards the camera (src/passes/volumes/volumetric.h), at coarse texels.
#include "shared/scene.h"
#include "shared/volumetric.h"
layout(push_constant, scalar) uniform Push { VolumetricMarchPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_data.glsl"
#include "lib/light_list.glsl"
#include "lib/fog_medium.glsl"
#include "lib/fog_ray.glsl"
layout(constant_id = 0) const int DEPTH_SAMPLES = 0;
#include "lib/coarse_depth.glsl"
#ifdef LAMP_SHADOWS
#include "lib/fog_lamp_shadow.glsl"
#endif
#ifdef FOG_DEEP_SHADOWS
#include "lib/deep_light.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;

// (k + 1/2)/n^2 of a Bayer matrix n texels wide: what is next to each other begins far from each other.
float bayer_offset(uvec2 texel, uint n) {
  uint k = 0u;
  for (uint i = 1u; i < n; i *= 2u) {
    const uint x = texel.x / i & 1u, y = texel.y / i & 1u;
    k = 4u * k + (2u * (x ^ y) + y);
  }
  return (float(k) + 0.5) / float(n * n);
}

void main() {
  // Threads beside the picture follow its last texels, for the walk through the lists takes all lanes.
  const uvec2 texel = min(gl_GlobalInvocationID.xy, pc.texels - 1u);
  float metres;
  const ivec2 pixel = coarse_pixel(texel, pc.texel_px, pc.rule, metres);
  const FogRay ray = fog_ray(coarse_ndc(pixel));
  const float end_m = min(metres * ray.along, pc.farthest_m);
  const float wide = end_m / float(pc.samples), offset = bayer_offset(texel, pc.bayer);
  precise vec3 sum = vec3(0.0);
  for (uint i = 0u; i < pc.samples; ++i) {
    const float begin = wide * float(i), at = begin + wide * offset;
    const vec3 position = ray.origin + ray.direction * at;
    // Of the step, what arrives at the camera; its limit where tau is 0.
    const float x = pc.tau * wide;
    const float arrives = exp(-min(pc.tau * begin, FOG_OPAQUE)) * wide * one_minus_exp_over(x);
    for (LightWalk w = begin_lights(position); next_light(w);) {
      LightRef light = light_at(pc.lights, w.light);
      const vec2 xy = light_word(light, 0u), z_range = light_word(light, 1u), z_type = light_word(light, 3u);
      const uint type = floatBitsToUint(z_type.y);
      if (type == light_directional || type == light_stand_in) continue;
      const vec3 to_lamp = vec3(xy, z_range.x) - position;
      const float d2 = dot(to_lamp, to_lamp), x2 = d2 * (z_range.y * z_range.y);
      if (!(x2 < 1.0) || !(d2 < 3.0e36)) continue;
      const float d = sqrt(d2), window = max(1.0 - x2 * x2, 0.0);
      const vec3 l = d > 0.0 ? to_lamp / d : vec3(0.0, 1.0, 0.0);
      float factor = window;
      if (type == light_spot) {
        const vec2 cone = light_word(light, 4u);
        const vec3 e = l + vec3(light_word(light, 2u), z_type.x);
        const float c = clamp(cone.y - dot(e, e) * cone.x, 0.0, 1.0);
        factor *= c * c;
      }
      factor *= pc.formula == volumetric_extinction ? pc.tau : window;
      factor *= exp(-min(pc.tau * d, FOG_OPAQUE)) * henyey_greenstein(dot(l, ray.direction), pc.anisotropy);
      if (!(factor > 0.0)) continue;
      vec3 intensity = light_intensity(light);
#ifdef LAMP_SHADOWS
      const uint maps = fog_lamp_maps(light);
      factor *= fog_lamp_visibility(maps, position);
      if (!(factor > 0.0)) continue;
#ifdef FOG_DEEP_SHADOWS
      if (maps != no_light) intensity *= deep_lamp(maps, position, vec3(0.0), 0.0);
#endif
#endif
      // The inverse square as its mean over the step: an angle over the lamp's distance from the ray.
      const float along = dot(to_lamp, ray.direction);  // the lamp lies this far on from the point
      const vec3 aside = to_lamp - ray.direction * along;
      const float h2 = max(dot(aside, aside), frame.least_light_distance2), h = sqrt(h2);
      const float a = begin - at - along, b = a + wide;
      const float mean = wide * h > 1e-30 ? atan(wide * h, h2 + a * b) / (h * wide) : 1.0 / (h2 + along * along);
      sum += intensity * (factor * mean * arrives);
    }
  }
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, pc.texels))) return;
  imageStore(storage_images[pc.target], ivec2(texel), vec4(sum * (pc.phi * frame.pre_exposure), metres));
}
