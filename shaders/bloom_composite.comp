#version 460
// The picture and its glow, and the luminance of both by groups of threads, in an order that does not change.
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

// Of a pixel: luminance before and after.
vec2 compose(ivec2 p, vec3 glow) {
  const vec4 color = texelFetch(pass_images[pc.color], p, 0);
  precise vec3 composed = color.rgb;  // first less, then more: what keeps its light stays within floats
  if (pc.keeps != 0u) {
    const vec3 source = HAS_SOURCE != 0 ? texelFetch(pass_images[pc.source], p, 0).rgb : color.rgb;
    composed -= pc.strength * bloom_bright(source, pc.threshold, pc.knee);
  }
  composed += pc.strength * glow;
  imageStore(storage_images[pc.composed], p, vec4(composed, color.a));
  if (HAS_GLOW != 0) imageStore(storage_images[pc.glow], p, vec4(glow, 1.0));
  const float part = 2.3283064e-10;  // 2^-32, so that sums are floats too
  return vec2(bloom_luminance(bloom_clean(color.rgb) * part), bloom_luminance(bloom_clean(composed) * part));
}

// A thread makes four pixels, as bloom_tents has them.
void main() {
  const ivec2 q = ivec2(gl_GlobalInvocationID.xy), first = 2 * q - 1;
  vec2 energy = vec2(0.0);
  if (all(lessThan(first, ivec2(pc.size_px)))) {
    vec3 glows[4];
    if (HALVED != 0) bloom_tents(pc.bloom, q, glows);
    for (int i = 0; i < 4; ++i) {
      const ivec2 p = first + ivec2(i & 1, i >> 1);
      if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(pc.size_px)))) continue;
      energy += compose(p, HALVED != 0 ? glows[i] * pc.bloom_weight : texelFetch(pass_images[pc.bloom], p, 0).rgb);
    }
  }
  energies[gl_LocalInvocationIndex] = energy;
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < bloom_group; ++i) sum += energies[i];
  EnergiesRef(pc.energies).e[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = sum;
}
