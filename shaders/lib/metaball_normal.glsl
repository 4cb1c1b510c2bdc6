#pragma once
// Normals turned by the slope of gradient noise (Perlin, "Improving Noise", 2002), which repeats after 256 cells.

vec3 noise_direction(ivec3 corner) {
  const uvec3 c = uvec3(corner) & 255u;
  uint h = c.x * 0x8da6b343u ^ c.y * 0xd8163841u ^ c.z * 0xcb1ab31fu;
  h ^= h >> 13;
  h *= 0x9e3779b1u;
  h ^= h >> 16;
  // One of the middles of a cube's edges.
  const float a = (h & 1u) != 0u ? -1.0 : 1.0, b = (h & 2u) != 0u ? -1.0 : 1.0;
  const uint axis = (h >> 2) % 3u;
  return axis == 0u ? vec3(0.0, a, b) : axis == 1u ? vec3(a, 0.0, b) : vec3(a, b, 0.0);
}

vec3 noise_slope(vec3 at) {
  const vec3 cell = floor(at), w = at - cell;
  const vec3 fade = w * w * w * (w * (w * 6.0 - 15.0) + 10.0), rise = 30.0 * w * w * (w * (w - 2.0) + 1.0);
  vec3 slope = vec3(0.0);
  for (int i = 0; i < 8; ++i) {
    const ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2);
    const vec3 high = vec3(corner), share = mix(1.0 - fade, fade, high), change = mix(-rise, rise, high);
    const vec3 direction = noise_direction(ivec3(cell) + corner);
    slope += share.x * share.y * share.z * direction + dot(direction, w - high) *
        vec3(change.x * share.y * share.z, share.x * change.y * share.z, share.x * share.y * change.z);
  }
  return slope;
}

// amplitude: below 1, so that no normal turns by more than 45 degrees.
vec3 turned_normal(vec3 n, vec3 at, float amplitude) {
  const vec3 slope = noise_slope(at), bounded = slope * inversesqrt(1.0 + dot(slope, slope));
  return normalize(n - amplitude * (bounded - dot(bounded, n) * n));
}
