#ifndef CANDELA_SHARED_PROBES_H
#define CANDELA_SHARED_PROBES_H
#include "shared/types.h"

SHARED_BEGIN

#ifdef __cplusplus
inline constexpr uint most_probes = 8;
#else
const uint most_probes = 8u;
#endif

// A reflection probe (lib/probes.glsl): an image of the scene about its position, filtered as skies are, that stands
// for what lies on the faces of its box. Relative space, metres.
struct Probe {
  vec3 position;
  uint texture;  // of its slices, bindless
  vec3 lowest;
  float fade_m;  // outside the box, over which its light gives way
  vec3 highest;
  uint unused;
};

struct ProbeLights {
  uint64_t slices;  // where slices lie in a texture; all probes have one size
  uint lobe_texture, clamp_sampler;
  Probe probe[most_probes];  // smaller boxes first
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(Probe) == 48 && sizeof(ProbeLights) == 400);
}
#else
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ProbeLightsRef { ProbeLights l[]; };
#endif

#endif
