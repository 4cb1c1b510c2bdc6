#version 460
// Depth of reliefs; what a ray passes by is dropped.
#ifndef RELIEF  // defined wherever it is used, to what lib/relief_fragment.glsl says
#define RELIEFS 1
#define RELIEF 1
#endif
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#include "lib/surface.glsl"
#include "lib/relief_fragment.glsl"
layout(location = 0) in flat uint in_item;

void main() {
  if (!put_relief(in_item)) discard;
}
