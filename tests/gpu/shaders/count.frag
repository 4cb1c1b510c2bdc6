#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
// Counts its fragments.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counter { uint n; };
layout(push_constant, scalar) uniform Push { vec4 color; Counter counter; } push;
layout(location = 0) out vec4 color;
void main() {
  atomicAdd(push.counter.n, 1u);
  color = push.color;
}
