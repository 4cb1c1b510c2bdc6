#pragma once
// Which of a sequence's places the rays of a pixel take. Needs the push constants pc.rays (RaySettings) and
// pc.subsample, and PIXEL_MIDDLE.
#include "shared/trace.h"

// Which of how many points share what the pixel has of rays.
uint rays_part = 0u, rays_parts = 1u;
uint rays_first(uint count) { return (pc.subsample * rays_parts + rays_part) * count; }
uint rays_share(uint count) { return max((count + rays_parts - 1u) / rays_parts, 1u); }

uint rays_hash(uvec3 v) {  // Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020 (pcg3d)
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  return v.x;
}
// Number i of a sequence whose first 2^n points stratify the square in every way (Sobol 1967, two dimensions), turned
// over by the pixel's own bits.
vec2 rays_place(uint i, uvec2 own) {
  uint second = 0u;
  for (uint v = 0x80000000u, n = i; n != 0u; n >>= 1u, v ^= v >> 1u)
    if ((n & 1u) != 0u) second ^= v;
  return vec2(uvec2(bitfieldReverse(i), second) ^ own) * (1.0 / 4294967296.0);
}
uvec2 rays_own(uint dimension) {
  const RaySettings s = RaySettingsRef(pc.rays).s;
  const uvec2 pixel = uvec2(PIXEL_MIDDLE);
  return uvec2(rays_hash(uvec3(pixel, s.seed ^ (2u * dimension))),
      rays_hash(uvec3(pixel, s.seed ^ (2u * dimension + 1u))));
}
