#version 460
// 16 bytes a thread into a buffer.
#include "push.glsl"
void main() {
  const uint i = index();
  if (i < pc.count) Words(pc.target).w[i] = uvec4(i);
}
