#version 460
// How many fragments of blended surfaces a pixel has.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/frame.glsl"
#include "shared/transparency.h"
layout(early_fragment_tests) in;

void main() {
  atomicAdd(CellWordsRef(pc.table).w[first_count + pixel_number(uvec2(gl_FragCoord.xy), frame.size_px)], 1u);
}
