#version 460
// Brings long lists into light order, a group a list, by the bitonic network of Batcher 1968 in the form whose
// comparisons all point one way, which takes any length. light_rank.comp does short ones.
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightSortPush pc; };
layout(local_size_x = 256) in;
layout(constant_id = 0) const int CAPPED = 0;  // count what the cap loses

const uint most_shared = 4096u;
shared uint keys[most_shared];
shared uint long_cells[light_sort_cells];
shared uint long_count;

void compare(uint base, uint a, uint b, uint count) {
  if (b >= count) return;  // as if the list went on with infinities
  const uint x = UintsRef(pc.entries).u[base + a], y = UintsRef(pc.entries).u[base + b];
  if (x > y) {
    UintsRef(pc.entries).u[base + a] = y;
    UintsRef(pc.entries).u[base + b] = x;
  }
}
void compare_shared(uint a, uint b, uint count) {
  if (b >= count) return;
  const uint x = keys[a], y = keys[b];
  if (x > y) {
    keys[a] = y;
    keys[b] = x;
  }
}

void sort_list(uint base, uint count) {
  const uint t = gl_LocalInvocationIndex;
  const bool fits = count <= most_shared;
  for (uint i = t; i < count; i += gl_WorkGroupSize.x) {
    const uint light = ConstUintsRef(pc.unsorted).u[base + i];
    if (fits)
      keys[i] = light;
    else
      UintsRef(pc.entries).u[base + i] = light;
  }
  memoryBarrierBuffer();
  barrier();
  const uint half_count = 1u << findMSB(count - 1u);  // pairs of the next power of two
  for (uint size = 2u; size <= 2u * half_count; size *= 2u) {
    // Flip: the mirror image inside each block. Then steps of halves.
    for (uint step = size / 2u; step > 0u; step /= 2u) {
      const bool flip = step == size / 2u;
      for (uint i = t; i < half_count; i += gl_WorkGroupSize.x) {
        const uint in_block = i % step, start = i / step * 2u * step;
        const uint a = start + in_block, b = flip ? start + 2u * step - 1u - in_block : a + step;
        if (fits)
          compare_shared(a, b, count);
        else
          compare(base, a, b, count);
      }
      memoryBarrierBuffer();
      barrier();
    }
  }
  if (fits)
    for (uint i = t; i < count; i += gl_WorkGroupSize.x) UintsRef(pc.entries).u[base + i] = keys[i];
  barrier();
}

void main() {
  // Long lists are neighbours: each group takes cells that lie far apart.
  const uint t = gl_LocalInvocationIndex, cell = gl_WorkGroupID.x + gl_NumWorkGroups.x * t;
  if (t == 0u) long_count = 0u;
  barrier();
  if (t < light_sort_cells && cell < pc.cells) {
    const uint count = ConstUintsRef(pc.offsets).u[cell + 1u] - ConstUintsRef(pc.offsets).u[cell];
    if (CAPPED != 0 && count > pc.cap) {
      atomicAdd(UintsRef(pc.report).u[0], count - pc.cap);
      atomicAdd(UintsRef(pc.report).u[1], 1u);
      atomicMax(UintsRef(pc.report).u[2], count);
    }
    if (count > most_ranked_lights) long_cells[atomicAdd(long_count, 1u)] = cell;
  }
  barrier();
  const uint longs = long_count;
  for (uint i = 0u; i < longs; ++i) {
    const uint c = long_cells[i], first = ConstUintsRef(pc.offsets).u[c];
    sort_list(first, ConstUintsRef(pc.offsets).u[c + 1u] - first);
  }
}
