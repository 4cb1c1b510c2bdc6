#version 460
// Writes the draw commands of the items that stay without gaps, in item order: the place of a command is the number of
// bits before its own, summed from the counts of `cull` and the words of its group. No atomics, so every run gives the
// same order.
#extension GL_EXT_control_flow_attributes : require
#include "lib/cull.glsl"

const uint runs = 16u, run_size = cull_group_size / runs;
shared uint part[cull_group_size];
shared uint run_part[runs];
shared uint words[cull_mask_words];

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint flat_place = flat_group();
  if (flat_place >= pc.group_count * pc.view_count) return;  // the whole workgroup
  const uint view = HAS_VIEW_TABLE != 0 ? flat_place / pc.group_count : 0u;
  const uint first_of_view = view * pc.group_count;
  const CullGroup group = CullGroupsRef(pc.groups).g[flat_place - first_of_view];
  // Survivors of the run's earlier groups: each thread sums a stride, the first of 16 threads their sums, and all add
  // those. lavapipe compiles a barrier in a loop slowly.
  uint sum = 0u;
  for (uint i = first_of_view + group.first_group + t; i < flat_place; i += cull_group_size)
    sum += CountsRef(pc.survivors).n[i];
  part[t] = sum;
  if (t < cull_mask_words) words[t] = MasksRef(pc.masks).m[flat_place * cull_mask_words + t];
  barrier();
  const uint first = t / run_size * run_size;
  uint parts = 0u;
  [[dont_unroll]] for (uint i = first; i < first + run_size; ++i) parts += part[i];
  if (t == first) run_part[t / run_size] = parts;
  barrier();
  uint before = 0u;
  [[dont_unroll]] for (uint r = 0u; r < runs; ++r) before += run_part[r];
  // Without a table a run's commands begin at its first item's place: the groups of a run follow one another.
  const uint region = view * pc.run_count + group.run;
  const uint first_command = HAS_VIEW_TABLE != 0
      ? RegionsRef(pc.regions).first[region] : CullGroupsRef(pc.groups).g[group.first_group].first_item;
  const uint bit = 1u << (t % 32u);
  if ((words[t / 32u] & bit) != 0u) {
    uint place = first_command + before + uint(bitCount(words[t / 32u] & (bit - 1u)));
    for (uint w = 0u; w < t / 32u; ++w) place += uint(bitCount(words[w]));
    const uint index = group.first_item + t;
    const Item item = ItemsRef(frame.items).i[index];
    DrawCommandsRef(pc.commands).d[place] = DrawCommand(item.index_count, 1u, item.first_index, 0, index);
  }
  if (t == 0u && group.is_last != 0u)
    CountsRef(pc.counts).n[region] = before + CountsRef(pc.survivors).n[flat_place];
}
