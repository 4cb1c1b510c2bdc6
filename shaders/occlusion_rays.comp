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
#include "lib/occlusion_texel.glsl"
#include "lib/rays.glsl"

// Squares of 4 by 4 texels share a sequence, a stretch of it each, so that the filter sees all directions evenly.
const uint PATTERN_SIDE = 4u, PATTERN_TEXELS = 16u;
// Places of a square by what the bits of a sequence's numbers halve first: neighbours are far apart in it.
uint place_in_pattern(uvec2 texel) {
  const uvec2 p = texel % PATTERN_SIDE;
  const uint x = p.x, y = p.x ^ p.y;
  return (y & 1u) << 3 | (x & 1u) << 2 | (y & 2u) | (x & 2u) >> 1;
}

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(texel), pc.texels))) return;
  float point = texel_point(texel);
  vec3 n = vec3(0.0, 0.0, 1.0);
  SkyOpen open = SkyOpen(1.0, 0.0, 0.0, n);
  float mirror = 1.0;
  if (point > 0.0) {
    const vec3 p = occlusion_point(texel, point, SHAPE, pc.subsample_ndc);
    const vec3 position = p.x * frame.camera_right + p.y * frame.camera_up + p.z * frame.camera_back;
    const vec3 to_viewer = frame.perspective != 0u ? normalize(-position) : frame.camera_back;
    // An edge where the rasterizer covers more than the triangle: the texels about it know its surface.
    const bool found = find_origin(position, to_viewer);
    const uvec2 square = uvec2(texel) / PATTERN_SIDE;
    const uvec2 own = uvec2(rays_hash(uvec3(square, 2u * pc.seed)), rays_hash(uvec3(square, 2u * pc.seed + 1u)));
    const uint first = (PATTERN_TEXELS * pc.subsample + place_in_pattern(uvec2(texel))) * pc.count;
    open = sky_open(false, first, pc.count, own);
    mirror = mirror_open(to_viewer);
    n = vec3(dot(rays_side, frame.camera_right), dot(rays_side, frame.camera_up), dot(rays_side, frame.camera_back));
    if (!found) point = 0.0;
  }
  if (KEEPS_NORMALS != 0) imageStore(storage_uint_images[pc.normals], texel, uvec4(pack_normal(n)));
  const float both = pack_open(open.fraction, mirror);
  imageStore(storage_images[pc.open], texel, vec4(both, point, open.bright, open.bright_open));
}
