#version 460
// One colour where nothing was drawn.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { BackgroundPush pc; };
layout(location = 0) out vec4 out_radiance;
void main() { out_radiance = pc.color; }
