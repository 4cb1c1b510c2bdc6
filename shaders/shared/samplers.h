#ifndef CANDELA_SHARED_SAMPLERS_H
#define CANDELA_SHARED_SAMPLERS_H
#include "shared/types.h"
// The samplers of graph images (lib/image_kinds.glsl), in all mips. Depth is reversed, so a shadow sampler answers
// whether the reference lies at least as near to the light as the map: 1 where it does, weighted over four texels.
#define SAMPLER_LINEAR_CLAMP 0
#define SAMPLER_LINEAR_REPEAT 1
#define SAMPLER_NEAREST_CLAMP 2
#define SAMPLER_NEAREST_REPEAT 3
#define SAMPLER_SHADOW_LINEAR 4  // reference >= texel
#define SAMPLER_SHADOW_NEAREST 5
#define SAMPLER_COUNT 6
#endif
