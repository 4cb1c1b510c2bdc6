#ifndef CANDELA_SHARED_POSE_LIGHTS_H
#define CANDELA_SHARED_POSE_LIGHTS_H
#include "shared/scene.h"

SHARED_BEGIN

// One of CANDELA_light_instances, as it stays: in the node's space, times the template. What is not given has the value
// that changes nothing.
struct LightInstance {
  vec3 translation;
  vec3 direction;  // 0: the node's
  vec3 color;
  float intensity;
  float inverse_range;         // 0: the template's
  float depth, period, phase;  // LightModulation
};

// Lights that stand together in the frame's list: instances of one node, or lights that the host has posed.
struct LightGroup {
  dvec3 origin, x_axis, y_axis, z_axis;  // relative space from the node's
  double candela;                        // of the template
  Light light;                           // the template; its intensity is the colour alone
  uint first, count;                     // in the frame's list
  uint source;                           // the first instance, or posed light
  uint posed;                            // 1: by the host
};

struct PoseLightsPush {
  double time_s;
  uint64_t groups, instances, posed;
  uint64_t lights;
  uint group_count, light_count;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(LightInstance) == 56 && sizeof(LightGroup) == 184 && sizeof(PoseLightsPush) == 48);
}  // namespace candela::shared
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightInstancesRef { LightInstance i[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer LightGroupsRef { LightGroup g[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightsRef { Light l[]; };
#endif
#endif
