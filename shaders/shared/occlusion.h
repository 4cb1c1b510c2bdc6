#ifndef CANDELA_SHARED_OCCLUSION_H
#define CANDELA_SHARED_OCCLUSION_H
#include "shared/types.h"

// Where the points of the occlusion's texels lie (lib/occlusion_points.glsl): one number, so that shaders get it as a
// specialization constant.
#define OCCLUSION_TEXEL_PX(shape) ((shape)&0xff)        // side of a texel in pixels: 1, 2 or 4
#define OCCLUSION_SAMPLES(shape) ((shape) >> 8 & 0xff)  // depth samples of a pixel
#define OCCLUSION_BENT(shape) ((shape) >> 16 & 1)       // 1: the mean open direction is kept too
#define OCCLUSION_BY_RAYS(shape) ((shape) >> 17 & 1)    // 1: how bright the sky is, and what is open of it, are kept

SHARED_BEGIN
struct OcclusionPointsPush {
  uint64_t keys;  // in the place of depth
  uint depth, points;
  uvec2 points_px;  // size of their image: the picture's, or by rays in texels
};
struct OcclusionPush {
  uint64_t keys;  // in the place of depth
  uint depth, points, normals, open;
  uvec2 texels;  // size in texels
  vec2 subsample_ndc;
  float radius_m, fade_m;  // hidden by saturate((radius - distance) / fade), or parts of a point's distance
  uint by_distance;        // 1: they are
  float strength;
  int slices, samples;  // samples on each side of a slice
  float turn;           // of the first slice, as a part of the angle between slices
  uvec2 pattern;        // by which the pattern of 4 by 4 texels is moved
};
struct OcclusionRaysPush {
  uint64_t keys;         // in the place of depth
  uint64_t trees, rays;  // TraceScene, RaySettings
  uint depth, points, normals, open;
  uvec2 texels;
  vec2 subsample_ndc;
  uint subsample, count, most;  // rays of a texel, and where the filter finds few of its surface
  uint rounds;                  // of the filter
  uint seed;
};
// A round of the filter of texels by rays: taps `stride` texels apart.
struct OcclusionFilterPush {
  uint normals, open, smooth_open;
  uvec2 texels;
  vec2 subsample_ndc;
  int stride;
  float sharpness;  // at which difference of fractions a texel counts half: the root of their variance over it
};
struct OcclusionDenoisePush {
  uint normals, open, smooth_open;
  uvec2 texels;
  vec2 subsample_ndc;
  float reach_m;  // at which a texel counts half, or that part of the point's distance
  uint by_distance;
};
SHARED_END

// Threads of a group of the filter by rays. Threads by fours in y make rows of whole squares at a stride of 4.
#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint occlusion_filter_x = 16, occlusion_filter_y = 4;
}
#else
const uint occlusion_filter_x = 16u, occlusion_filter_y = 4u;
#endif

#endif
