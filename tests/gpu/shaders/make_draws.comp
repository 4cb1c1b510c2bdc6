#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
// Two draws of one triangle each, of which the count admits one.
layout(local_size_x = 1) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint w[]; };
layout(push_constant, scalar) uniform Push { Words commands, counts, indices; } push;
void main() {
  for (uint draw = 0u; draw < 2u; ++draw) {
    push.commands.w[draw * 5u] = 3u;
    push.commands.w[draw * 5u + 1u] = 1u;
    for (uint i = 2u; i < 5u; ++i) push.commands.w[draw * 5u + i] = 0u;
  }
  atomicAdd(push.counts.w[0], 1u);
  for (uint i = 0u; i < 3u; ++i) push.indices.w[i] = i;
}
