#ifndef CANDELA_SHARED_IMAGE_LIGHT_H
#define CANDELA_SHARED_IMAGE_LIGHT_H
#include "shared/types.h"

SHARED_BEGIN

// A filtered sky (sky/prefilter_sky.h makes it, lib/image_light.glsl reads it): slices for lobes of rising roughness,
// each an octahedral map in one texture. Slice i is of the perceptual roughness 2^((i - last) / per octave).
#ifdef __cplusplus
inline constexpr uint sky_slice_count = 15, sky_slices_per_octave = 3;
// The sky's bright spots are in the slices up to the first number, and lights of their own from the second on.
inline constexpr uint sky_lights_after = 4, sky_lights_from = 6;
inline constexpr uint sky_lobe_size = 32;
#else
const uint sky_slice_count = 15u, sky_slices_per_octave = 3u;
const uint sky_lights_after = 4u, sky_lights_from = 6u;
const uint sky_lobe_size = 32u;
#endif

// Where a slice lies: texture coordinates are offset + scale * (octahedral * 0.5 + 0.5).
struct SkySlice {
  vec2 offset, scale;
};

// A bright spot of the sky.
struct SkyLight {
  vec3 direction;    // unit, towards it, in the sky's own axes
  vec3 illuminance;  // on a surface that faces it
};

struct ImageLight {
  uint64_t slices, lights;
  uint texture, irradiance_texture, lobe_texture, clamp_sampler;  // bindless; absent without image-based light
  uint light_count;
  uint pixel_samples;  // of a lobe where the sky is sampled; of stretched facets where it is filtered
  vec2 irradiance_uv;  // offset and scale, as a slice's, on both axes
  vec2 rest_px;        // method sampled: size of the sky without its bright spots, which is the texture then
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(SkySlice) == 16 && sizeof(SkyLight) == 24 && sizeof(ImageLight) == 56);
}
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SkySlicesRef { SkySlice s[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SkyLightsRef { SkyLight s[]; };
#endif

#endif
