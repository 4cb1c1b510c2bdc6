#version 460
// 4,096 fused multiplications and additions of floats a thread, in eight chains that do not wait for one another.
#include "push.glsl"
void main() {
  const uint i = index();
  if (i >= pc.count) return;
  vec4 a = vec4(i), b = vec4(i + 1u);
  const vec4 m = vec4(0.999, 0.998, 0.997, 0.996);
  for (uint k = 0u; k < 512u; ++k) {
    a = fma(a, m, vec4(1.0));
    b = fma(b, m, vec4(1.0));
  }
  // Never true, which no compiler knows.
  if (a.x + a.y + a.z + a.w + b.x + b.y + b.z + b.w == -1.0) Words(pc.target).w[i] = uvec4(a);
}
