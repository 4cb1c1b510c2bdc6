#version 460
// The picture and its glow, and the luminance of both by groups of 64 pixels, in an order that does not change.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomCompositePush pc; };
#include "lib/bindless.glsl"
#include "lib/bloom.glsl"
#include "lib/bloom_tent.glsl"
layout(local_size_x = bloom_group, local_size_y = 1) in;
layout(constant_id = 0) const int HAS_GLOW = 0;    // the glow is wanted as a layer
layout(constant_id = 1) const int HAS_SOURCE = 0;  // what glows is an image of its own
layout(constant_id = 2) const int HALVED = 0;      // the glow is of half the picture's size

shared vec2 energies[bloom_group];

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  vec2 energy = vec2(0.0);
  if (all(lessThan(p, pc.size_px))) {
    const vec4 color = texelFetch(pass_images[pc.color], ivec2(p), 0);
    vec3 glow;
    if (HALVED != 0)
      glow = bloom_tent(pc.bloom, ivec2(p)) * pc.bloom_weight;
    else
      glow = texelFetch(pass_images[pc.bloom], ivec2(p), 0).rgb;
    precise vec3 composed = color.rgb;  // first less, then more: what keeps its light stays within floats
    if (pc.keeps != 0u) {
      const vec3 source = HAS_SOURCE != 0 ? texelFetch(pass_images[pc.source], ivec2(p), 0).rgb : color.rgb;
      composed -= pc.strength * bloom_bright(source, pc.threshold, pc.knee);
    }
    composed += pc.strength * glow;
    imageStore(storage_images[pc.composed], ivec2(p), vec4(composed, color.a));
    if (HAS_GLOW != 0) imageStore(storage_images[pc.glow], ivec2(p), vec4(glow, 1.0));
    const float part = 2.3283064e-10;  // 2^-32, so that sums are floats too
    energy = vec2(bloom_luminance(bloom_clean(color.rgb) * part), bloom_luminance(bloom_clean(composed) * part));
  }
  energies[gl_LocalInvocationIndex] = energy;
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < bloom_group; ++i) sum += energies[i];
  EnergiesRef(pc.energies).e[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = sum;
}
