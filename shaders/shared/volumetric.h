#ifndef CANDELA_SHARED_VOLUMETRIC_H
#define CANDELA_SHARED_VOLUMETRIC_H
#include "shared/types.h"

SHARED_BEGIN

#ifdef __cplusplus
enum : uint { coarse_nearest = 0, coarse_checkerboard = 1 };
enum : uint { volumetric_extinction = 0, volumetric_attenuation = 1 };
#else
const uint coarse_nearest = 0u, coarse_checkerboard = 1u;
const uint volumetric_extinction = 0u, volumetric_attenuation = 1u;
#endif

// Light in the air of lamps, at texels of some pixels' side. Units: radiance as in beauty, pre-exposed.
struct VolumetricMarchPush {
  uint64_t keys;  // in the place of depth
  uint64_t lights, light_cells, light_entries, light_tiles, lamps;
  uint lamp_maps, depth, target;
  uvec2 texels;
  uint texel_px, rule;  // rule: which of a texel's depths it follows
  uint samples, bayer;  // bayer: side of the matrix of offsets
  float farthest_m;     // of a ray: no lamp reaches beyond
  float phi, tau, anisotropy;
  uint formula;
  uint shadow_colors;  // as in DrawPush
};
struct VolumetricFilterPush {
  uint source, target;
  uvec2 texels;
  uint down;  // along columns; otherwise along rows
  uint radius;
  float deviation, depth_fraction;  // depth_fraction: of a depth: farther texels are another surface; 0: none
};
struct VolumetricCompositePush {
  uint64_t keys;  // in the place of depth
  uint color, light, depth, composed, layer;
  uvec2 size_px, texels;
  uint texel_px, aware;  // aware: of depths; otherwise bilinear
};
SHARED_END

#endif
