#version 460
// 16 bytes a thread from one buffer to another.
#include "push.glsl"
void main() {
  const uint i = index();
  if (i < pc.count) Words(pc.target).w[i] = Words(pc.source).w[i];
}
