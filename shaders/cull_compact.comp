#version 460
// Writes the surviving items' draw commands without gaps, in item order: the place of a command is the number of
// survivors before it, summed from the counts of `cull` and a prefix sum inside the group. No atomics, so every run
// gives the same order.
#include "lib/cull.glsl"

shared uint prefix[cull_group_size];
shared uint before;

void main() {
  const uint t = gl_LocalInvocationIndex;
  const uint g = group_index();
  if (g >= pc.group_count) return;  // the whole workgroup
  const CullGroup group = CullGroupsRef(pc.groups).g[g];
  // Survivors of the run's earlier groups: each thread sums a stride, then a tree adds the threads.
  uint sum = 0u;
  for (uint i = group.first_group + t; i < g; i += cull_group_size) sum += CountsRef(pc.survivors).n[i];
  prefix[t] = sum;
  barrier();
  for (uint step = cull_group_size / 2u; step > 0u; step /= 2u) {
    if (t < step) prefix[t] += prefix[t + step];
    barrier();
  }
  if (t == 0u) before = prefix[0];
  barrier();
  const bool survives = t < group.item_count && item_survives(group.first_item + t);
  prefix[t] = survives ? 1u : 0u;
  barrier();
  for (uint step = 1u; step < cull_group_size; step *= 2u) {  // inclusive scan (Hillis and Steele 1986)
    const uint left = t >= step ? prefix[t - step] : 0u;
    barrier();
    prefix[t] += left;
    barrier();
  }
  // A run's commands begin at its first item's place: the groups of a run follow one another.
  const uint run_first_item = CullGroupsRef(pc.groups).g[group.first_group].first_item;
  if (survives) {
    const uint index = group.first_item + t;
    const Item item = ItemsRef(frame.items).i[index];
    DrawCommandsRef(pc.commands).d[run_first_item + before + prefix[t] - 1u] = DrawCommand(item.index_count, 1u,
        item.first_index, 0, index);
  }
  if (t == 0u && group.is_last != 0u) CountsRef(pc.counts).n[group.run] = before + prefix[cull_group_size - 1u];
}
