#version 460
// The blended samples of pixels that have fragments.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { FragmentsPush pc; };
#include "lib/sample_over.glsl"

layout(location = 0) out vec4 out_radiance;

void main() {
  const uint pixel = pixel_number(uvec2(gl_FragCoord.xy), pc.size_px);
  if (CellWordsRef(pc.cells).w[first_count + pixel] == 0u) discard;
  cover_sample();
  out_radiance = BlendedRef(pc.blended).c[pixel * uint(SAMPLES) + pc.sample_number];
}
