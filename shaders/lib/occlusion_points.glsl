#pragma once
// The points that ambient occlusion is computed at: each texel has one depth sample of its pixels, the first that a
// surface covers. Its distance in metres along the view axis is kept as a float whose last bits say which sample it is,
// so that the point is known exactly. 0: no surface. Needs lib/frame.glsl.
#include "lib/sample_places.glsl"
#include "shared/occlusion.h"

// Farther points would overflow when squared. They count as no surface.
const float OCCLUSION_FARTHEST_M = 1e18;

// How many of a point's last bits name its sample.
uint occlusion_name_mask(int shape) {
  return uint(OCCLUSION_TEXEL_PX(shape) * OCCLUSION_TEXEL_PX(shape) * OCCLUSION_SAMPLES(shape)) - 1u;
}

// 0 stays 0: no surface.
float occlusion_named(float metres, uint name, int shape) {
  return metres > 0.0 ? uintBitsToFloat((floatBitsToUint(metres) & ~occlusion_name_mask(shape)) | name) : 0.0;
}

// In pixels of the picture.
vec2 occlusion_place_px(ivec2 texel, float point, int shape) {
  const uint side = uint(OCCLUSION_TEXEL_PX(shape)), samples = uint(OCCLUSION_SAMPLES(shape));
  const uint name = floatBitsToUint(point) & occlusion_name_mask(shape);
  const uint pixel = name / samples;
  return vec2(texel * int(side) + ivec2(pixel % side, pixel / side)) +
      sample_place_px(int(samples), name % samples);
}

// Camera space: right, up, back. metres: along the view axis.
vec3 occlusion_position(vec2 place_px, float metres, vec2 subsample_ndc) {
  const vec2 ndc = 2.0 * place_px / vec2(frame.size_px) - 1.0 + subsample_ndc;
  const vec2 across = vec2(ndc.x, -ndc.y) * frame.tan_half;
  return frame.perspective != 0u ? vec3(across, -1.0) * metres : vec3(across, -metres);
}
vec3 occlusion_point(ivec2 texel, float point, int shape, vec2 subsample_ndc) {
  return occlusion_position(occlusion_place_px(texel, point, shape), point, subsample_ndc);
}

// Unit vectors in 32 bits (Meyer et al., "On Floating-Point Normal Vectors", 2010). The first component of all-zero
// bits is a vector too.
vec2 place_of_normal(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  return n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(n.xy, vec2(0.0)));
}
uint pack_normal(vec3 n) { return packSnorm2x16(place_of_normal(n)); }
vec3 normal_at_place(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  const float under = max(-n.z, 0.0);
  n.xy -= mix(vec2(-under), vec2(under), greaterThanEqual(n.xy, vec2(0.0)));
  return normalize(n);
}
vec3 unpack_normal(uint bits) { return normal_at_place(unpackSnorm2x16(bits)); }

// What a point of another surface counts for one at p with normal n: by its distance from the tangent plane, in parts
// of the distance from the camera.
const float OCCLUSION_PLANE_TOLERANCE = 0.01;
// How fast a texel by rays counts less whose normal turns away: half at 20 degrees.
const float OCCLUSION_TURN = 16.6;
float occlusion_likeness(vec3 point, vec3 p, vec3 n) {
  const float off = dot(n, point - p) / (OCCLUSION_PLANE_TOLERANCE * max(-p.z, 1e-30));
  return exp2(-off * off);
}
