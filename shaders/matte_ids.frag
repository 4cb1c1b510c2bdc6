#version 460
#ifdef RELIEF
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/relief_fragment.glsl"
layout(location = 10) in flat uint in_item;
#endif
layout(location = 0) in flat float in_id;
layout(location = 0) out float out_id;

void main() {
#ifdef RELIEF
  if (!put_relief(in_item)) discard;
#endif
  out_id = in_id;
}
