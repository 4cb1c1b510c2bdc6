#version 460
// The nearest depth sample of each texel, never an average, which would be a surface that does not exist; and the
// normal of the surface there, from the depths of the same sample of the pixels beside it.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionPointsPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SHAPE = 257;

const int SAMPLES = OCCLUSION_SAMPLES(SHAPE), TEXEL_PX = OCCLUSION_TEXEL_PX(SHAPE);

float sample_depth(ivec2 p, int s) {
  return SAMPLES > 1 ? texelFetch(pass_multisampled_images[pc.depth], p, s).r
      : texelFetch(pass_images[pc.depth], p, 0).r;
}
// 0 outside the picture.
float depth_beside(ivec2 p, int s) {
  if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(frame.size_px)))) return 0.0;
  return sample_depth(p, s);
}
// Metres in front of the camera. Perspective: depth = near/z. Orthographic: depth = z_scale * -z_view + z_bias.
float depth_m(float d) {
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / d;
  const vec3 row = vec3(m[0][2], m[1][2], m[2][2]);
  return max((m[3][2] - d) / length(row), 1e-30);
}

// The difference of the positions at p and beside it along one axis, from the side whose surface goes on through p.
// On a plane depth is linear over the picture: the side is taken whose two next depths, prolonged, miss p's less. Where
// there is none the surface is taken to be as far off as at p.
vec3 difference(ivec2 p, ivec2 axis, int s, float depth, float metres, vec3 at, vec2 place_px) {
  vec3 best = occlusion_position(place_px + vec2(axis), metres, pc.subsample_ndc) - at;
  float least = 3e38;
  for (int side = -1; side <= 1; side += 2) {
    const float d1 = depth_beside(p + side * axis, s), d2 = depth_beside(p + 2 * side * axis, s);
    if (!(d1 > 0.0)) continue;
    const float miss = abs((d2 > 0.0 ? 2.0 * d1 - d2 : d1) - depth);
    if (!(miss < least)) continue;
    least = miss;
    best = float(side) * (occlusion_position(place_px + vec2(side * axis), depth_m(d1), pc.subsample_ndc) - at);
  }
  return best;
}

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  float nearest = 0.0;
  uint name = 0u;
  for (int i = 0; i < TEXEL_PX * TEXEL_PX; ++i) {
    const ivec2 p = TEXEL_PX * texel + ivec2(i % TEXEL_PX, i / TEXEL_PX);
    if (any(greaterThanEqual(uvec2(p), frame.size_px))) continue;
    for (int s = 0; s < SAMPLES; ++s) {
      const float d = sample_depth(p, s);
      if (d > nearest) {
        nearest = d;
        name = uint(i * SAMPLES + s);
      }
    }
  }
  float point = 0.0;
  vec3 normal = vec3(0.0, 0.0, 1.0);
  const float metres = nearest > 0.0 ? depth_m(nearest) : 0.0;
  if (nearest > 0.0 && metres < OCCLUSION_FARTHEST_M) {
    point = uintBitsToFloat((floatBitsToUint(metres) & ~occlusion_name_mask(SHAPE)) | name);
    const int s = int(name) % SAMPLES, pixel = int(name) / SAMPLES;
    const ivec2 p = TEXEL_PX * texel + ivec2(pixel % TEXEL_PX, pixel / TEXEL_PX);
    const vec2 place_px = vec2(p) + occlusion_sample_px(SAMPLES, uint(s));
    const vec3 at = occlusion_position(place_px, metres, pc.subsample_ndc);
    // Scaled: the square of a difference may underflow or overflow.
    const vec3 dx = difference(p, ivec2(1, 0), s, nearest, metres, at, place_px) / metres,
               dy = difference(p, ivec2(0, 1), s, nearest, metres, at, place_px) / metres;
    const vec3 to_eye = frame.perspective != 0u ? -normalize(at / metres) : vec3(0.0, 0.0, 1.0);
    vec3 n = cross(dx, dy);
    const float size = length(n);
    n = size > 0.0 ? n / size : to_eye;
    normal = dot(n, to_eye) < 0.0 ? -n : n;
  }
  imageStore(storage_images[pc.points], texel, vec4(point));
  imageStore(storage_uint_images[pc.normals], texel, uvec4(pack_normal(normal)));
}
