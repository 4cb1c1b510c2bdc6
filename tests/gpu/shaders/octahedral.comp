#version 460
// Directions as they come back from their octahedral bits.
#include "shared/types.h"
#include "lib/octahedral.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int BITS = 16;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Directions { vec3 d[]; };
layout(push_constant, scalar) uniform Push { Directions from, to; uint count; } push;
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.count) push.to.d[i] = octahedral_direction(octahedral_bits(push.from.d[i], uint(BITS)), uint(BITS));
}
