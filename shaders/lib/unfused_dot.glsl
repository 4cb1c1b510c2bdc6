#pragma once
// A dot product without fused multiply-adds, which drivers place otherwise from shader to shader: for numbers that a
// threshold or a difference of nearly equal ones makes of, where techniques must agree.
float unfused_dot(vec3 a, vec3 b) {
  precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}
