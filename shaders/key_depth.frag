#version 460
// The depth that a sample's key holds.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { SamplesPush pc; };
#include "lib/sample_of_buffer.glsl"

void main() {
  gl_FragDepth = uintBitsToFloat(uint(KeysRef(pc.source).k[place_of_sample()] >> 32));
}
