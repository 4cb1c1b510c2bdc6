#ifndef CANDELA_SHARED_SHADOWS_H
#define CANDELA_SHARED_SHADOWS_H
#include "shared/types.h"

SHARED_BEGIN

#ifdef __cplusplus
inline constexpr uint max_sun_cascades = 8;
#else
const uint max_sun_cascades = 8u;
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
  SunCascade cascades[max_sun_cascades];  // the finest first
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(SunCascade) == 20 && sizeof(SunShadow) == 224 && offsetof(SunShadow, cascades) == 64);
}
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SunShadowsRef { SunShadow s[]; };
#endif

#endif
