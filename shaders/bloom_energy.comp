#version 460
// Adds the groups' luminance up: one group, each thread a stride of its own, then the threads in order.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomEnergyPush pc; };
layout(local_size_x = bloom_group, local_size_y = 1) in;

shared vec2 energies[bloom_group];

void main() {
  vec2 sum = vec2(0.0);
  for (uint i = gl_LocalInvocationIndex; i < pc.count; i += bloom_group) sum += EnergiesRef(pc.energies).e[i];
  energies[gl_LocalInvocationIndex] = sum;
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  sum = vec2(0.0);
  for (uint i = 0u; i < bloom_group; ++i) sum += energies[i];
  BloomReportRef(pc.report).r.before = sum.x;
  BloomReportRef(pc.report).r.after = sum.y;
}
