#version 460
// Adds the groups' luminance up: one group, each thread a stride of its own, then the threads by halves, in an order
// that does not change.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomEnergyPush pc; };
layout(local_size_x = bloom_energy_group, local_size_y = 1) in;

shared vec2 energies[bloom_energy_group];

const uint ahead = 8u;  // sums that are loaded before the first of them is added

void main() {
  vec2 sum = vec2(0.0);
  for (uint first = gl_LocalInvocationIndex; first < pc.count; first += ahead * bloom_energy_group) {
    vec2 parts[ahead];
    for (uint i = 0u; i < ahead; ++i)
      parts[i] = EnergiesRef(pc.energies).e[min(first + i * bloom_energy_group, pc.count - 1u)];
    for (uint i = 0u; i < ahead; ++i)
      if (first + i * bloom_energy_group < pc.count) sum += parts[i];
  }
  energies[gl_LocalInvocationIndex] = sum;
  barrier();
  for (uint half_count = bloom_energy_group / 2u; half_count > 0u; half_count /= 2u) {
    if (gl_LocalInvocationIndex < half_count)
      energies[gl_LocalInvocationIndex] += energies[gl_LocalInvocationIndex + half_count];
    barrier();
  }
  if (gl_LocalInvocationIndex != 0u) return;
  BloomReportRef(pc.report).r.before = energies[0].x;
  BloomReportRef(pc.report).r.after = energies[0].y;
}
