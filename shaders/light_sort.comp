#version 460
// Brings each cell's list into light order, so that the same frame gives the same bytes: one thread a short list
// (insertion), the whole group a long one (bitonic network of Batcher 1968, in the form whose comparisons all point one
// way, which takes any length).
#include "shared/lights.h"
layout(push_constant, scalar) uniform Push { LightSortPush pc; };
layout(local_size_x = 64) in;
layout(constant_id = 0) const int CAPPED = 0;  // count what the cap loses

const uint most_short = 48u;
shared uint long_cells[64];
shared uint long_count;

void compare(uint base, uint a, uint b, uint count) {
  if (b >= count) return;  // as if the list went on with infinities
  const uint x = UintsRef(pc.entries).u[base + a], y = UintsRef(pc.entries).u[base + b];
  if (x > y) {
    UintsRef(pc.entries).u[base + a] = y;
    UintsRef(pc.entries).u[base + b] = x;
  }
}

void sort_long(uint base, uint count) {
  const uint t = gl_LocalInvocationIndex;
  for (uint i = t; i < count; i += 64u) UintsRef(pc.entries).u[base + i] = ConstUintsRef(pc.unsorted).u[base + i];
  memoryBarrierBuffer();
  barrier();
  const uint half_count = 1u << findMSB(count - 1u);  // pairs of the next power of two
  for (uint size = 2u; size <= 2u * half_count; size *= 2u) {
    for (uint i = t; i < half_count; i += 64u) {  // flip: mirror image inside each block
      const uint in_block = i % (size / 2u), start = i / (size / 2u) * size;
      compare(base, start + in_block, start + size - 1u - in_block, count);
    }
    memoryBarrierBuffer();
    barrier();
    for (uint step = size / 4u; step > 0u; step /= 2u) {
      for (uint i = t; i < half_count; i += 64u) {
        const uint at = i / step * 2u * step + i % step;
        compare(base, at, at + step, count);
      }
      memoryBarrierBuffer();
      barrier();
    }
  }
}

void main() {
  const uint cell = gl_WorkGroupID.x * 64u + gl_LocalInvocationIndex;
  if (gl_LocalInvocationIndex == 0u) long_count = 0u;
  barrier();
  const bool is_cell = cell < pc.cells;
  const uint base = is_cell ? ConstUintsRef(pc.offsets).u[cell] : 0u;
  const uint count = is_cell ? ConstUintsRef(pc.offsets).u[cell + 1u] - base : 0u;
  if (CAPPED != 0 && count > pc.cap) {
    atomicAdd(UintsRef(pc.report).u[0], count - pc.cap);
    atomicAdd(UintsRef(pc.report).u[1], 1u);
    atomicMax(UintsRef(pc.report).u[2], count);
  }
  if (count > most_short) {
    long_cells[atomicAdd(long_count, 1u)] = cell;
  } else {
    for (uint i = 0u; i < count; ++i) {
      const uint light = ConstUintsRef(pc.unsorted).u[base + i];
      uint at = i;
      while (at > 0u) {
        const uint before = UintsRef(pc.entries).u[base + at - 1u];
        if (before < light) break;
        UintsRef(pc.entries).u[base + at] = before;
        --at;
      }
      UintsRef(pc.entries).u[base + at] = light;
    }
  }
  barrier();
  const uint longs = long_count;
  for (uint i = 0u; i < longs; ++i) {
    const uint c = long_cells[i], first = ConstUintsRef(pc.offsets).u[c];
    sort_long(first, ConstUintsRef(pc.offsets).u[c + 1u] - first);
  }
}
