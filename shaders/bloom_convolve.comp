#version 460
// The exact end: one axis of a Gaussian over the whole picture, out to four standard deviations, clamped to the edge.
// Along x it reads the picture and takes what blooms; along y it adds its level to the sum.
#include "shared/bloom.h"
layout(push_constant, scalar) uniform Push { BloomConvolvePush pc; };
#include "lib/bindless.glsl"
#include "lib/bloom.glsl"
layout(local_size_x = bloom_group, local_size_y = 1) in;
layout(constant_id = 0) const int ALONG_Y = 0;
layout(constant_id = 1) const int ADDS = 0;
layout(constant_id = 2) const int COUNTS = 0;

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(p, ivec2(pc.size_px)))) return;
  if (COUNTS != 0) {
    const vec3 c = texelFetch(pass_images[pc.source], p, 0).rgb;
    if (any(isnan(c)) || any(isinf(c))) atomicAdd(BloomReportRef(pc.report).r.nonfinite, 1u);
  }
  const int radius = int(ceil(4.0 * pc.sigma_px));
  const float scale = -0.5 / (pc.sigma_px * pc.sigma_px);
  float weights = 0.0;
  for (int i = -radius; i <= radius; ++i) weights += exp(scale * float(i * i));
  precise vec3 sum = vec3(0.0);  // weighed before it is added: sums of the brightest lie beyond floats
  for (int i = -radius; i <= radius; ++i) {
    const float w = exp(scale * float(i * i)) / weights;
    const ivec2 q = clamp(ALONG_Y != 0 ? p + ivec2(0, i) : p + ivec2(i, 0), ivec2(0), ivec2(pc.size_px) - 1);
    vec3 c = texelFetch(pass_images[pc.source], q, 0).rgb;
    if (ALONG_Y == 0) c = bloom_bright(c, pc.threshold, pc.knee);
    sum += w * c;
  }
  if (ALONG_Y != 0) sum *= pc.weight;
  if (ADDS != 0) sum += texelFetch(pass_images[pc.sum], p, 0).rgb;
  imageStore(storage_images[pc.target], p, vec4(sum, 1.0));
}
