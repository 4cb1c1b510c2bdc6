#version 460
// A 64-bit atomic maximum a thread, each of a place of its own, neighbours beside one another.
#extension GL_EXT_shader_atomic_int64 : require
#include "push.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Keys { uint64_t k[]; };
void main() {
  const uint i = index();
  if (i < pc.count) atomicMax(Keys(pc.target).k[i], uint64_t(i));
}
