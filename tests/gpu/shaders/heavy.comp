#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
// Work without memory traffic: many rounds of an integer hash. Writes its result so that nothing can be left out.
layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint w[]; };
layout(push_constant, scalar) uniform Push { Words target; uint rounds; } push;
void main() {
  uint x = gl_GlobalInvocationID.x;
  for (uint i = 0u; i < push.rounds; ++i) {
    x ^= x >> 16;
    x = x * 0x7feb352du + i;
  }
  push.target.w[gl_GlobalInvocationID.x] = x;
}
