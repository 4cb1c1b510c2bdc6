#version 460
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/draw.vert.glsl"
