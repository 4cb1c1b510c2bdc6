#version 460
// Which lights are seen, and in which list each is drawn: a bit a light, counted by groups. ORDERED: all in the first.
#include "lib/frame.glsl"
#include "shared/light_volumes.h"
layout(push_constant, scalar) uniform Push { LightVolumesPush pc; };
#include "lib/light_data.glsl"
#include "lib/light_volume.glsl"
layout(local_size_x = 256) in;
shared uint words[volume_lists * light_volumes_words];

void main() {
  const uint t = gl_LocalInvocationIndex, group = gl_WorkGroupID.x, number = gl_GlobalInvocationID.x;
  const uint places = volume_lists * light_volumes_words;
  if (t < places) words[t] = 0u;
  barrier();
  const bool is_light = number < frame.light_count;
  uint list = volume_list(light_at(pc.lights, is_light ? number : 0u));
#ifdef ORDERED
  if (list < volume_lists) list = 0u;
#endif
  if (is_light && list < volume_lists) atomicOr(words[list * light_volumes_words + t / 32u], 1u << (t % 32u));
  barrier();
  if (t < places) VolumeWordsRef(pc.masks).w[group * places + t] = words[t];
  if (t < volume_lists) {
    uint count = 0u;
    for (uint w = 0u; w < light_volumes_words; ++w) count += uint(bitCount(words[t * light_volumes_words + w]));
    VolumeWordsRef(pc.counts).w[group * volume_lists + t] = count;
  }
}
