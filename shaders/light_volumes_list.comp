#version 460
// The lists of the lights that are drawn, in ascending order, and their draw commands: a light's place is the number of
// bits before its own.
#include "lib/frame.glsl"
#include "shared/light_volumes.h"
layout(push_constant, scalar) uniform Push { LightVolumesPush pc; };
layout(local_size_x = 256) in;
shared uint before[volume_lists];

void main() {
  const uint t = gl_LocalInvocationIndex, group = gl_WorkGroupID.x;
  if (t < volume_lists) before[t] = 0u;
  barrier();
  VolumeWordsRef counts = VolumeWordsRef(pc.counts), masks = VolumeWordsRef(pc.masks);
  for (uint list = 0u; list < volume_lists; ++list) {
    uint sum = 0u;
    for (uint g = t; g < group; g += light_volumes_group) sum += counts.w[g * volume_lists + list];
    if (sum != 0u) atomicAdd(before[list], sum);
  }
  barrier();
  VolumeWordsRef lists = VolumeWordsRef(pc.lists);
  const uint bit = 1u << (t % 32u);
  for (uint list = 0u; list < volume_lists; ++list) {
    const uint first = (group * volume_lists + list) * light_volumes_words, word = masks.w[first + t / 32u];
    if ((word & bit) == 0u) continue;
    uint place = before[list] + uint(bitCount(word & (bit - 1u)));
    for (uint w = 0u; w < t / 32u; ++w) place += uint(bitCount(masks.w[first + w]));
    lists.w[list * frame.light_count + place] = group * light_volumes_group + t;
  }
  if (group + 1u == pc.group_count && t < volume_lists) {
    const uint lights = before[t] + counts.w[group * volume_lists + t];
    VolumeDrawsRef draws = VolumeDrawsRef(pc.draws);
#ifdef ORDERED
    const uint vertices = volume_vertices;
#else
    const uint vertices = t == volumes_everywhere ? 3u : volume_vertices;
#endif
    draws.v.draw[t] = VolumeDraw(vertices, lights, 0u, 0u);
    draws.v.count[t] = min(lights, 1u);
  }
}
