#pragma once
// Lights with a size, as seen from a point. Needs lib/light_data.glsl, lib/axes.glsl, lib/features.glsl and what
// lib/ray_sequence.glsl needs.
#include "lib/ray_sequence.glsl"

const float light_at_infinity = 3.0e38;

// Of a light from a point: a cap of directions about an axis, seen with one radiance.
struct LightCap {
  vec3 axis;
  float centre_m;  // distance of the middle; light_at_infinity: a sun
  float radius_m;
  float height;    // 1 - cos of its half angle: 0 a point, 2 all directions
};
LightCap light_cap(LightRef light, vec3 position) {
  const vec2 z_type = light_word(light, 3u);
  LightCap cap;
  if (floatBitsToUint(z_type.y) == light_directional) {
    cap.axis = -vec3(light_word(light, 2u), z_type.x);
    cap.centre_m = light_at_infinity;
    cap.radius_m = 0.0;
    cap.height = SUNS_SOFT ? light_word(light, 7u).y : 0.0;
    return cap;
  }
  const vec3 to_light = vec3(light_word(light, 0u), light_word(light, 1u).x) - position;
  cap.centre_m = length(to_light);
  cap.axis = cap.centre_m > 0.0 ? to_light / cap.centre_m : vec3(0.0, 1.0, 0.0);
  cap.radius_m = LAMPS_SOFT ? light_word(light, 7u).x : 0.0;
  const float sine = cap.radius_m / max(cap.centre_m, 1e-30);
  cap.height = !(cap.radius_m > 0.0) ? 0.0 : sine < 1.0 ? sine * sine / (1.0 + sqrt(1.0 - sine * sine)) : 2.0;
  return cap;
}

// Number i of the places on the light, which stratify it: evenly in solid angle. l: its direction. Its distance.
float place_on_light(LightCap cap, uint i, uvec2 own, out vec3 l) {
  l = cap.axis;
  if (!(cap.height > 0.0)) return cap.centre_m;
  const vec2 u = rays_place(i, own);
  const float down = u.x * cap.height, across2 = down * (2.0 - down), phi = 6.2831853 * u.y;
  l = normalize(axes_about(cap.axis) * vec3(sqrt(across2) * vec2(cos(phi), sin(phi)), 1.0 - down));
  if (!(cap.radius_m > 0.0)) return cap.centre_m;
  const float along = cap.centre_m * (1.0 - down);  // to its surface
  const float behind = sqrt(max(cap.radius_m * cap.radius_m - cap.centre_m * cap.centre_m * across2, 0.0));
  return max(cap.height == 2.0 ? along + behind : along - behind, 0.0);
}

// The same from every point.
uint light_samples(LightCap cap) {
  if (!(cap.height > 0.0) && !(cap.radius_m > 0.0)) return 1u;
  const RaySettings s = RaySettingsRef(pc.rays).s;
  return rays_share(cap.centre_m < light_at_infinity ? s.lamp_samples : s.sun_samples);
}
