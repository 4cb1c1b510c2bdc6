#version 460
// How open the surface at a pixel of each texel is to the sky, by rays (src/passes/occlusion/occlusion.h).
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionRaysPush pc; };
#include "lib/features.glsl"
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/occlusion_points.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 30) const int SHAPE = 257;
layout(constant_id = 31) const int KEEPS_NORMALS = 0;
vec2 pixel_middle;
#define PIXEL_MIDDLE pixel_middle
#include "lib/occlusion_depth.glsl"
#include "lib/rays.glsl"

// Squares of 4 by 4 texels share a sequence, a stretch of it each, so that the filter sees all directions evenly.
const uint PATTERN_SIDE = 4u, PATTERN_TEXELS = 16u;
// Of the texels that the filter can take the mean over, so many with a ray each are enough.
const float ENOUGH = 0.35;
// Places of a square by what the bits of a sequence's numbers halve first: neighbours are far apart in it.
uint place_in_pattern(uvec2 texel) {
  const uvec2 p = texel % PATTERN_SIDE;
  const uint x = p.x, y = p.x ^ p.y;
  return (y & 1u) << 3 | (x & 1u) << 2 | (y & 2u) | (x & 2u) >> 1;
}

float texel_point(ivec2 texel) { return texelFetch(pass_images[pc.points], texel, 0).r; }

// Of the texels about one, as far as a round of the filter reaches, those that it takes for the same surface: by their
// distance from the plane of the triangle, and by how far a surface through both has turned that bends evenly, as their
// own normals are not known yet.
float same_surface(ivec2 texel, vec3 p, vec3 n, int away) {
  float same = 0.0;
  for (int i = 0; i < 9; ++i) {
    const ivec2 other = texel + away * (ivec2(i % 3, i / 3) - 1);
    if (i == 4 || any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(pc.texels)))) continue;
    const float point = texel_point(other);
    if (!(point > 0.0)) continue;
    const vec3 q = occlusion_point(other, point, SHAPE, pc.subsample_ndc), to = q - p;
    const float off = dot(n, to), turned2 = 4.0 * off * off / max(dot(to, to), 1e-30);
    same += occlusion_likeness(q, p, n) * exp2(-0.5 * OCCLUSION_TURN * turned2);
  }
  return same / 8.0;
}

// More where the filter will find few texels to take the mean over: on what is narrow or bends, whose noise would be
// seen to crawl as the camera moves.
uint rays_of(ivec2 texel, vec3 p, vec3 n) {
  if (pc.most == pc.count) return pc.count;
  const float in_round = float(PATTERN_TEXELS) - 1.0;
  float texels = 1.0 + in_round * same_surface(texel, p, n, 2), all = in_round + 1.0;
  if (pc.rounds > 1u) texels *= 1.0 + in_round * same_surface(texel, p, n, 7), all *= in_round + 1.0;
  // In powers of two, whose stretches of the sequence are even.
  const uint times = 1u << uint(max(ceil(log2(ENOUGH * all / (texels * float(pc.count)))), 0.0));
  return min(times * pc.count, max(pc.most, pc.count));
}

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  float point = texel_point(texel);
  vec3 n = vec3(0.0, 0.0, 1.0);
  SkyOpen open = SkyOpen(1.0, 0.0, 0.0, n, 1.0, 1.0);
  if (point > 0.0) {
    const vec3 p = occlusion_point(texel, point, SHAPE, pc.subsample_ndc);
    const vec3 position = p.x * frame.camera_right + p.y * frame.camera_up + p.z * frame.camera_back;
    const vec3 to_viewer = frame.perspective != 0u ? normalize(-position) : frame.camera_back;
    // An edge where the rasterizer covers more than the triangle: the texels about it know its surface.
    const bool found = find_origin(position, to_viewer);
    const uvec2 square = uvec2(texel) / PATTERN_SIDE;
    const uvec2 own = uvec2(rays_hash(uvec3(square, 2u * pc.seed)), rays_hash(uvec3(square, 2u * pc.seed + 1u)));
    n = vec3(dot(rays_side, frame.camera_right), dot(rays_side, frame.camera_up), dot(rays_side, frame.camera_back));
    const uint count = rays_of(texel, p, n);
    const uint first = (PATTERN_TEXELS * pc.subsample + place_in_pattern(uvec2(texel))) * count;
    open = sky_open(false, true, to_viewer, first, count, own);
    if (!found) point = 0.0;
  }
  if (KEEPS_NORMALS != 0) imageStore(storage_uint_images[pc.normals], texel, uvec4(pack_normal(n)));
  // How open the sky's bright spots are goes with its diffuse light.
  const float bright_open = sky_has_lights()
      ? pack_open(open_diffuse(open.fraction, open.bright, open.bright_open), open.lights)
      : open.bright_open;
  imageStore(storage_images[pc.open], texel,
      vec4(pack_open(open.fraction, open.mirror), point, open.bright, bright_open));
}
