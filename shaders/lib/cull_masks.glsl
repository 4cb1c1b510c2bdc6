#pragma once
#extension GL_EXT_control_flow_attributes : require
// A bit for each item of a group, by workgroups of cull_group_size threads. Needs shared/cull.h.
shared uint mask_words[cull_mask_words];

bool item_bit(uint64_t masks, uint group) {
  const uint t = gl_LocalInvocationIndex;
  return (MasksRef(masks).m[group * cull_mask_words + t / 32u] & (1u << (t % 32u))) != 0u;
}

// Writes the group's bits, and how many are set, which it returns to the first thread. All threads of the workgroup
// call it.
uint write_masks(bool keeps, uint64_t masks, uint64_t survivors, uint group) {
  const uint t = gl_LocalInvocationIndex;
  barrier();
  if (t < cull_mask_words) mask_words[t] = 0u;
  barrier();
  if (keeps) atomicOr(mask_words[t / 32u], 1u << (t % 32u));
  barrier();
  if (t < cull_mask_words) MasksRef(masks).m[group * cull_mask_words + t] = mask_words[t];
  if (t != 0u) return 0u;
  uint count = 0u;
  [[dont_unroll]] for (uint w = 0u; w < cull_mask_words; ++w) count += uint(bitCount(mask_words[w]));
  CountsRef(survivors).n[group] = count;
  return count;
}
