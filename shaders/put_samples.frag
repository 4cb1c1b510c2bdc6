#version 460
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { SamplesPush pc; };
#include "lib/sample_of_buffer.glsl"
layout(location = 0) out vec4 out_radiance;

void main() {
  out_radiance = SamplesRef(pc.source).s[place_of_sample()];
}
