#version 460
// The first depth sample of each pixel that a surface covers, or by rays of each texel: never an average, which would
// be a surface that does not exist, and not the nearest, which makes all that stands before something else wider.
#include "shared/occlusion.h"
layout(push_constant, scalar) uniform Push { OcclusionPointsPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/occlusion_points.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SHAPE = 257;

#include "lib/occlusion_depth.glsl"
#include "lib/occlusion_texel.glsl"

float pixel_point(ivec2 pixel) {
  float point = 0.0;
  for (int s = 0; s < SAMPLES && !(point > 0.0); ++s) {
    const float d = sample_depth(pixel, s);
    const float metres = d > 0.0 ? depth_m(d) : 0.0;
    if (metres < OCCLUSION_FARTHEST_M) point = occlusion_named(metres, uint(s), PIXELS);
  }
  return point;
}

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(p), pc.points_px))) return;
  float point = 0.0;
  if (OCCLUSION_BY_RAYS(SHAPE) != 0) {
    for (int i = 0; i < TEXEL_PX * TEXEL_PX && !(point > 0.0); ++i) {
      const ivec2 pixel = texel_pixel(p, i);
      if (all(lessThan(uvec2(pixel), frame.size_px))) point = point_of_texel(pixel_point(pixel), i);
    }
  } else {
    point = pixel_point(p);
  }
  imageStore(storage_images[pc.points], p, vec4(point));
}
