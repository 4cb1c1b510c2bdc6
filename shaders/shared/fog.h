#ifndef CANDELA_SHARED_FOG_H
#define CANDELA_SHARED_FOG_H
#include "shared/types.h"

SHARED_BEGIN

#ifdef __cplusplus
inline constexpr uint max_fog_media = 9;
#else
const uint max_fog_media = 9u;
#endif

// One medium of several.
struct FogBox {
  vec3 extinction;  // per metre at density 1
  float falloff;
  vec3 albedo;
  float height;
  vec3 glow;
  float anisotropy;
  vec3 lowest, highest;
  vec2 turn, middle;  // of the bounds: cosine and sine, and the x and z about which
  uint bounded;
};

// The fog of a look (look/look.h) in relative space, and the grid that its light is kept in. All zero without fog.
struct FogMedium {
  vec3 extinction;  // per metre at density 1
  float falloff;    // per metre
  vec3 scattering;
  float height;  // where the density is 1, above the eye
  vec3 glow;     // emission over extinction
  float anisotropy;
  vec3 lowest, highest;  // bounds
  uint bounded;          // 0: there are none
  // Rays of the grid across and down, from edge to edge of the picture, and the depths at which each keeps its light:
  // nearest_m * 2^(k * log2_ratio), the last at the ray's end. A march follows the ray of its own pixel by as many.
  uvec3 nodes;
  float nearest_m, log2_ratio;
  uint sky_directions;  // in which the fog before the sky is looked through
  // Several media: all of them, and what stands above is of the first. Shaders know how many (FOG_MEDIA).
  FogBox media[max_fog_media];
};

struct FogLightPush {
  uint64_t lights, light_cells, light_entries, light_tiles, suns, lamps;
  uint sun_maps, lamp_maps, target;
  uint shadow_colors;  // as in DrawPush
};
struct FogMarchPush {
  uint64_t lights, light_cells, light_entries, light_tiles, suns, lamps;
  uint64_t keys;  // in the place of depth
  uint sun_maps, lamp_maps, depth, target;
  uvec2 texels;
  uint texel_px, steps;
  float loss;  // of the light that came so far, what a step may take
  uint seed;
  uint shadow_colors;  // as in DrawPush
};
struct FogSumPush {
  uint image;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(FogBox) == 92 && sizeof(FogMedium) == 100 + 9 * 92 && offsetof(FogMedium, media) == 100);
}
#endif

#endif
