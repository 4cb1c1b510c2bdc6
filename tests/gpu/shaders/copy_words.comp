#version 460
// Copies 32-bit words from a buffer of the device to one that the host reads.
#include "shared/types.h"
layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint w[]; };
layout(push_constant, scalar) uniform Push { uint64_t source, target; uint count; } push;
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < push.count) Words(push.target).w[i] = Words(push.source).w[i];
}
