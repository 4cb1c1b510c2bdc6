#pragma once
// Surfaces at the pixels' middles as reflections know them, in camera space (right, up, back). Needs lib/frame.glsl and
// lib/bindless.glsl, pc.at and pc.subsample_ndc.
//   z            depth, 0 where there is none
//   surface      half floats f0 (3) and f90; shading normal; the triangle's normal, both on the viewer's side
//   reflectance  half floats: the fraction of an even light that the lobe sends to the camera (3), through fog;
//                roughness
//   sky          the ambient specular light that it would get, unoccluded; the fraction that near surfaces leave
#include "lib/occlusion_points.glsl"

struct Reflecting {
  vec3 normal, plane;
  vec3 f0;
  float f90;
};
uvec4 pack_reflecting(Reflecting r) {
  return uvec4(packHalf2x16(r.f0.rg), packHalf2x16(vec2(r.f0.b, r.f90)), pack_normal(r.normal), pack_normal(r.plane));
}
Reflecting unpack_reflecting(uvec4 bits) {
  const vec2 b = unpackHalf2x16(bits.y);
  return Reflecting(unpack_normal(bits.z), unpack_normal(bits.w), vec3(unpackHalf2x16(bits.x), b.x), b.y);
}
uvec2 pack_reflectance(vec3 fraction, float roughness) {
  // Half floats end at 65504; no share does.
  return uvec2(packHalf2x16(fraction.rg), packHalf2x16(vec2(fraction.b, roughness)));
}
vec4 unpack_reflectance(uvec2 bits) { return vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y)); }

vec3 to_camera_space(vec3 v) {
  return vec3(dot(v, frame.camera_right), dot(v, frame.camera_up), dot(v, frame.camera_back));
}
vec3 from_camera_space(vec3 v) {
  return v.x * frame.camera_right + v.y * frame.camera_up + v.z * frame.camera_back;
}

// Metres along the view axis. Perspective: depth = near/z. Orthographic: depth = -z_scale z + bias.
float metres_of(float depth) {
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / depth;
  return (m[3][2] - depth) / length(vec3(m[0][2], m[1][2], m[2][2]));
}
float depth_of(float metres) {
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / metres;
  return m[3][2] - metres * length(vec3(m[0][2], m[1][2], m[2][2]));
}
vec2 place_px(vec3 p) {
  vec2 across = p.xy / frame.tan_half;
  if (frame.perspective != 0u) across /= -p.z;
  return (vec2(across.x, -across.y) - pc.subsample_ndc + 1.0) * 0.5 * vec2(frame.size_px);
}

// Of the 4 by 4 texels from one on: their order in a pattern where each quarter holds all quarters.
uint pattern_of(uvec2 texel) {
  const uvec2 t = texel & 3u;
  const uint x = t.x ^ t.y;
  return (x & 1u) << 3 | (t.y & 1u) << 2 | (x & 2u) | (t.y & 2u) >> 1;
}
