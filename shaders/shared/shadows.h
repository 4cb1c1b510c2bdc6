#ifndef CANDELA_SHARED_SHADOWS_H
#define CANDELA_SHARED_SHADOWS_H
#include "shared/types.h"

SHARED_BEGIN

#ifdef __cplusplus
inline constexpr uint max_sun_cascades = 8;
inline constexpr float lamp_near_m = 1e-16f, lamp_kernel_texels = 2;
inline constexpr uint lamp_shadow_bit = 0x80000000u;
#else
const uint max_sun_cascades = 8u;
const float lamp_near_m = 1e-16, lamp_kernel_texels = 2.0;
const uint lamp_shadow_bit = 0x80000000u;  // of Light.shadow
#endif

// One square of a sun's shadow map, in the light's own axes, metres from the camera.
struct SunCascade {
  vec2 centre_m;
  float half_m;     // of the whole map
  float covered_m;  // of the square whose points find all their texels inside the map; less than half_m
  float texel_m;
};

// A directional light with shadow maps. Points are in relative space.
struct SunShadow {
  vec3 right, up, to_light;  // unit axes, the first two across the light
  vec4 depth;  // reversed depth of a point is dot(depth, (point, 1)): 1 at the side of the light, 0 at the other
  float bias;  // of the depth, for what rounding does to it
  uint cascade_count, first_layer;
  float tangent;                          // of the radius of its disc in the sky; 0: a point
  SunCascade cascades[max_sun_cascades];  // the finest first
};

// A point or spot light with shadow maps, square tiles of one layered image: six of a cube with the world's axes, or
// one down a spot's cone. The reversed depth of a point at z metres along a map's axis is lamp_near_m / z. Points are
// in relative space; tangents are metres across at a metre along. Shaders read it by 64-bit words (lib/lamp_face.glsl).
struct LampTilePlace {
  uint middle_px;  // in texels: x, and y from bit 16 on
  float layer;     // -1: the camera sees nothing that lies there
};
struct LampShadow {
  vec3 position;
  uint form;            // 1: a cube; from bit 1 on LampKnobs::pixel_places
  float texel_tangent;  // a texel's side
  float most_tangent;   // of a lookup's middle: from there it does not leave the tile
  float uv_per_texel;
  float bias_m;             // of z, for what rounding does to it
  vec3 right, up, forward;  // of the one map
  float unused;
  LampTilePlace tiles[6];
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(SunCascade) == 20 && sizeof(SunShadow) == 228 && offsetof(SunShadow, cascades) == 68);
static_assert(sizeof(LampShadow) == 120 && offsetof(LampShadow, right) == 32 && offsetof(LampShadow, tiles) == 72);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SunShadowsRef { SunShadow s[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer LampRef { uint64_t w[15]; };
#endif

#endif
