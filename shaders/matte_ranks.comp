#version 460
// The ids at a pixel's samples by their coverage, the largest first, of equal ones the lower id first.
#include "shared/mattes.h"
layout(push_constant, scalar) uniform Push { MatteRanksPush pc; };
#include "lib/image_kinds.glsl"
#include "lib/exact_float.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CountersRef { uint c[2]; };
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SAMPLES = 1;

uint id_at(uvec2 p, int s) {
#ifdef MULTISAMPLED
  return floatBitsToUint(texelFetch(pass_multisampled_images[pc.source], ivec2(p), s).r);
#else
  return floatBitsToUint(texelFetch(pass_array_images[pc.source], ivec3(p, s), 0).r);
#endif
}

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.size_px))) return;
  uint ids[SAMPLES], counts[SAMPLES];
  uint found = 0u;
  for (int s = 0; s < SAMPLES; ++s) {
    const uint id = id_at(p, s);
    if (id == 0u) continue;
    uint at = 0u;
    while (at < found && ids[at] != id) ++at;
    if (at == found) {
      ids[at] = id;
      counts[at] = 0u;
      ++found;
    }
    ++counts[at];
  }
  for (uint i = 1u; i < found; ++i) {
    const uint id = ids[i], count = counts[i];
    uint at = i;
    for (; at > 0u && (counts[at - 1u] < count || (counts[at - 1u] == count && ids[at - 1u] > id)); --at) {
      ids[at] = ids[at - 1u];
      counts[at] = counts[at - 1u];
    }
    ids[at] = id;
    counts[at] = count;
  }
  if (pc.report != 0ul && found > pc.ranks) {
    atomicAdd(CountersRef(pc.report).c[0], 1u);
    atomicMax(CountersRef(pc.report).c[1], found);
  }
  const uint ranks = min(found, pc.ranks);
  for (uint level = 0u; level < uint(MATTE_LEVELS_A_STEP); ++level) {
    const uint rank = pc.first_rank + 2u * level;
    if (rank >= pc.ranks) break;
    vec4 pair = vec4(0.0);
    if (rank < ranks) pair.xy = vec2(uintBitsToFloat(ids[rank]), rounded_quotient(float(counts[rank]), float(SAMPLES)));
    if (rank + 1u < ranks)
      pair.zw = vec2(uintBitsToFloat(ids[rank + 1u]), rounded_quotient(float(counts[rank + 1u]), float(SAMPLES)));
    imageStore(storage_images[pc.targets[level]], ivec2(p), pair);
  }
}
