#version 460
// A level of the way up: the coarser level through a 3x3 tent, and this level of the way down, each by its weight.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomUpPush pc; };
#include "lib/image_kinds.glsl"
layout(local_size_x = bloom_group, local_size_y = 1) in;
layout(constant_id = 0) const int HAS_FINE = 0;  // the last level up is the picture's: nothing of it is added

void main() {
  const uvec2 p = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(p, pc.target_px))) return;
  const vec2 texel = 1.0 / vec2(textureSize(pass_images[pc.coarse], 0));
  const vec2 uv = 0.5 * (vec2(p) + 0.5) * texel;
  precise vec3 sum = vec3(0.0);  // weighed before it is added: sums of the brightest lie beyond floats
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const float w = float((2 - abs(x)) * (2 - abs(y))) / 16.0;
      sum += w * texture(sampler2D(pass_images[pc.coarse], graph_samplers[SAMPLER_LINEAR_CLAMP]),
                         uv + vec2(x, y) * texel).rgb;
    }
  sum *= pc.coarse_weight;
  if (HAS_FINE != 0) sum += pc.fine_weight * texelFetch(pass_images[pc.fine], ivec2(p), 0).rgb;
  imageStore(storage_images[pc.target], ivec2(p), vec4(sum, 1.0));
}
