#version 460
// See-through surfaces as a light's view sees them. BENDS: bodies of glass where the light lands that they bend.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ColoredShadowPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#define PLACED
vec4 placed();
#include "lib/draw.vert.glsl"
#include "lib/colored_shadows.glsl"

#ifdef BENDS
#include "lib/bent_light.glsl"
#else
vec4 placed() { return view_place(out_position); }
#endif
