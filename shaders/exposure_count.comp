#version 460
// Histogram of the picture's luminance by its log2. Counts are whole numbers, so their order does not matter. What is
// darker or brighter than all bins falls into the first or the last; what is transparent or no number into none.
#include "shared/exposure.h"
layout(push_constant, scalar) uniform Push { ExposureCountPush pc; };
#include "lib/bindless.glsl"
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const uint BINS = 256u;

shared uint counts[BINS];

void main() {
  for (uint i = gl_LocalInvocationIndex; i < BINS; i += 64u) counts[i] = 0u;
  barrier();
  const uint x = gl_GlobalInvocationID.x, first = gl_GlobalInvocationID.y * exposure_rows;
  if (x < pc.size_px.x)
    for (uint y = first; y < min(first + exposure_rows, pc.size_px.y); ++y) {
      const vec4 c = texelFetch(pass_images[pc.source], ivec2(x, y), 0);
      const float alpha = clamp(c.a, 0.0, 1.0);
      const float light = dot(max(c.rgb, vec3(0.0)), vec3(0.2126, 0.7152, 0.0722));
      if (!(alpha > 0.0) || isnan(c.r + c.g + c.b)) continue;
      const float ev = log2(clamp(light / alpha * pc.scale, 1e-30, 1e30));
      const float place = (ev - exposure_darkest_ev) / (exposure_brightest_ev - exposure_darkest_ev);
      atomicAdd(counts[uint(clamp(place * float(BINS), 0.0, float(BINS) - 1.0))], 1u);
    }
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < BINS; i += 64u)
    if (counts[i] > 0u) atomicAdd(ExposureCountsRef(pc.counts).n[i], counts[i]);
}
